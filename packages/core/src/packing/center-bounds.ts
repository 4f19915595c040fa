import type { Vec3 } from '../math/mat4.ts';

/** Least and greatest coordinates, by axis, of the first `count` positions; ±Infinity if there are none. */
export function centerBounds(
  positions: Float32Array | Float64Array,
  count: number,
): { readonly min: Vec3; readonly max: Vec3 } {
  const min: [number, number, number] = [
    Number.POSITIVE_INFINITY,
    Number.POSITIVE_INFINITY,
    Number.POSITIVE_INFINITY,
  ];
  const max: [number, number, number] = [
    Number.NEGATIVE_INFINITY,
    Number.NEGATIVE_INFINITY,
    Number.NEGATIVE_INFINITY,
  ];
  for (let i = 0; i < 3 * count; i++) {
    const axis = i % 3;
    if (positions[i] < min[axis]) min[axis] = positions[i];
    if (positions[i] > max[axis]) max[axis] = positions[i];
  }
  return { min, max };
}
