import type { Bounds } from '../../data/packing/packed-cloud.ts';
import { colorDcOf } from '../../data/splats/color-values.ts';
import { GPU_FAULTS } from '../../data/splats/splat-set.ts';
import type { ReferenceSplat } from '../../reference/packing.ts';

/** Columns of splats, as the application's buffers hold them without gaps. */
export interface BufferColumns {
  readonly positions: Float32Array;
  readonly scales: Float32Array;
  readonly colors: Float32Array;
  readonly rotations: Float32Array | null;
  readonly opacities: Float32Array | null;
}

/** Scales are clamped as those of files. */
const MOST_LOG_SCALE = 40;

/**
 * Reference of pack-buffers, in float64: the splats before they are packed, null for those that are
 * not drawn, and how many have each fault.
 */
export function packBuffers(
  columns: BufferColumns,
  count: number,
  bounds: Bounds,
): { readonly splats: readonly (ReferenceSplat | null)[]; readonly faults: readonly number[] } {
  const faults = GPU_FAULTS.map(() => 0);
  const splats = Array.from({ length: count }, (_, i) => {
    const splat = splatOf(columns, i);
    const fault = faultOf(splat, bounds);
    if (fault >= 0) faults[fault]++;
    return fault < 0 && splat.opacity > 0 ? drawn(splat) : null;
  });
  return { splats, faults };
}

type GivenSplat = ReturnType<typeof splatOf>;

function splatOf({ positions, scales, colors, rotations, opacities }: BufferColumns, i: number) {
  const of = (values: Float32Array, width: number) => Array.from(values.subarray(width * i, width * (i + 1)));
  return {
    position: of(positions, 3),
    scale: of(scales, 3),
    rotation: rotations ? of(rotations, 4) : [0, 0, 0, 1],
    opacity: opacities ? opacities[i] : 1,
    color: of(colors, 3),
  };
}

/** Index in `GPU_FAULTS`; −1 if there is none. */
function faultOf({ position, scale, rotation, opacity, color }: GivenSplat, { min, max }: Bounds): number {
  const isInside = position.every((value, axis) => value >= min[axis] && value <= max[axis]);
  return [
    ...[position, scale, rotation, [opacity], color].map((each) => each.every(Number.isFinite)),
    isInside,
  ].indexOf(false);
}

function drawn({ position, scale, rotation, opacity, color }: GivenSplat): ReferenceSplat {
  const [x, y, z, w] = rotation;
  const length = Math.hypot(...rotation);
  const [least, most] = [Math.exp(-MOST_LOG_SCALE), Math.exp(MOST_LOG_SCALE)];
  const clamped = scale.map((value) => Math.min(most, Math.max(least, Math.abs(value))));
  const dc = color.map(colorDcOf);
  return {
    position: [position[0], position[1], position[2]],
    opacity: Math.min(1, opacity),
    rotation: length > 1e-30 ? [w / length, x / length, y / length, z / length] : [1, 0, 0, 0],
    scale: [clamped[0], clamped[1], clamped[2]],
    colorDc: [dc[0], dc[1], dc[2]],
  };
}
