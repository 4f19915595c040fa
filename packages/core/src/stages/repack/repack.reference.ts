import { type PackedGeometry, packGeometry } from '../../data/packing/geometry.ts';
import type { SplatColumns } from '../../data/splats/splat-set.ts';
import { unpackSplat } from '../../reference/packing.ts';

/**
 * Reference of repack-geometry, in float64: packs the float32 geometry of the splats of `set`, with
 * the ranges of log scales that were found when they were loaded.
 */
export function repackGeometry(set: SplatColumns, finer: PackedGeometry): PackedGeometry {
  return packGeometry({ ...set, ...unpackedColumns(finer, set.count) }, 'packed', finer.chunks);
}

/** The columns of geometry, with the values that packing rounded them to. */
export function unpackedColumns(geometry: PackedGeometry, count: number) {
  const splats = Array.from({ length: count }, (_, i) => unpackSplat(geometry, i));
  return {
    positions: Float32Array.from(splats.flatMap(({ position }) => position)),
    rotations: Float32Array.from(splats.flatMap(({ rotation }) => rotation)),
    logScales: Float32Array.from(splats.flatMap(({ scale }) => scale.map(Math.log))),
    opacityLogits: Float32Array.from(splats, ({ opacity }) => Math.log(opacity / (1 - opacity))),
    colorDc: Float32Array.from(splats.flatMap(({ colorDc }) => colorDc)),
  };
}

/** Reference of repack-sh: the host's own packer, which divides in float64. */
export { repackHarmonics as repackSh } from '../../data/packing/repack-harmonics.ts';
