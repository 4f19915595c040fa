import type { Vec3 } from '../math/mat4.ts';

/** Bounds of nothing, to be widened in place. */
export function emptyBounds(): {
  readonly min: [number, number, number];
  readonly max: [number, number, number];
} {
  const most = Number.POSITIVE_INFINITY;
  return { min: [most, most, most], max: [-most, -most, -most] };
}

/** Least and greatest coordinates, by axis, of the first `count` positions; ±Infinity if none. */
export function centerBounds(
  positions: Float32Array | Float64Array,
  count: number,
): { readonly min: Vec3; readonly max: Vec3 } {
  const bounds = emptyBounds();
  widenBounds(bounds, positions, 0, count);
  return bounds;
}

/** Widens bounds to hold positions `from` up to but not including `to`. */
export function widenBounds(
  { min, max }: ReturnType<typeof emptyBounds>,
  positions: Float32Array | Float64Array,
  from: number,
  to: number,
): void {
  for (let i = 3 * from; i < 3 * to; i++) {
    const axis = i % 3;
    if (positions[i] < min[axis]) min[axis] = positions[i];
    if (positions[i] > max[axis]) max[axis] = positions[i];
  }
}
