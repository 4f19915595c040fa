import type { DispatchSize, IndirectArguments } from '../gpu/passes.ts';

/** Reference of shaders/lib/dispatch.wgsl: x, y, z of `count` workgroups in rows of `row`. */
export function dispatchSize(count: number, row: number): [number, number, number] {
  return count <= row ? [count, 1, 1] : [row, Math.ceil(count / row), 1];
}

/**
 * Up to this many workgroups, it is cheaper to start all that may have work than to read their
 * number on the GPU: Dawn checks the arguments of every indirect dispatch in a dispatch of its own.
 * Measured with Dawn on an NVIDIA H200: a hundred of them took 14 of the 16 ms that recording and
 * submitting a frame of 50 small clouds took on the CPU; on the GPU, a frame of six million splats
 * got 0.06 ms faster without them, although most of the workgroups return at once.
 */
const MAX_DIRECT_WORKGROUPS = 32_768;
/**
 * The limit on software devices (`hasNarrowSubgroups`), where even a workgroup without work is slow: with
 * both cores busy, SwiftShader took 15 s for 8,500 workgroups of cull-splats, of which 62 had work.
 */
const MAX_DIRECT_NARROW_WORKGROUPS = 32;

/**
 * Returns the size of a dispatch of as many workgroups as `indirect` says, at most `bound`. With a
 * small `bound` that many are dispatched directly; workgroups without work return at once.
 *
 * @param isNarrow the device's `hasNarrowSubgroups`.
 */
export function sizeAtMost(
  bound: number,
  row: number,
  indirect: IndirectArguments,
  isNarrow: boolean,
): DispatchSize {
  const mostDirect = isNarrow ? MAX_DIRECT_NARROW_WORKGROUPS : MAX_DIRECT_WORKGROUPS;
  // At least one: Dawn warns of dispatches of nothing.
  return bound > mostDirect ? indirect : dispatchSize(Math.max(1, bound), row);
}
