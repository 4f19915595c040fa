/**
 * Squared distance of two vectors of `length` values, a multiple of three, in `a` from `i` and in
 * `b` from `j` on; or some number that is not below `bound`, if the distance is not.
 */
export function squaredDistance(
  a: Float32Array,
  i: number,
  b: Float32Array,
  j: number,
  length: number,
  bound: number,
): number {
  let sum = 0;
  for (const end = i + length; i < end; i += 3, j += 3) {
    const x = a[i] - b[j];
    const y = a[i + 1] - b[j + 1];
    const z = a[i + 2] - b[j + 2];
    sum += x * x + y * y + z * z;
    if (sum >= bound) return sum;
  }
  return sum;
}
