/** Twin of shaders/lib/dispatch.wgsl: dispatch size in x, y and z for `count` workgroups in rows of `row`. */
export function dispatchSize(count: number, row: number): [number, number, number] {
  return count <= row ? [count, 1, 1] : [row, Math.ceil(count / row), 1];
}

/**
 * Up to so many workgroups, starting all that may have work costs less than reading on the GPU how many have: Dawn checks the
 * arguments of every indirect dispatch in a dispatch of its own.
 */
const MAX_DIRECT_WORKGROUPS = 64;

/**
 * Dispatches as many workgroups as `indirect` says, at most `bound`: where that is few, all of them, of which the shader leaves
 * those without work.
 */
export function dispatchAtMost(
  pass: GPUComputePassEncoder,
  bound: number,
  row: number,
  indirect: { readonly buffer: GPUBuffer; readonly offset: number },
): void {
  if (bound > MAX_DIRECT_WORKGROUPS) pass.dispatchWorkgroupsIndirect(indirect.buffer, indirect.offset);
  // At least one: Dawn warns of dispatches of nothing.
  else pass.dispatchWorkgroups(...dispatchSize(Math.max(1, bound), row));
}
