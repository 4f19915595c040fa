/** Unit quaternion of the four values from `at` on; the identity where they are all zero. */
export function normalizedRotation(
  rotations: Float32Array | Float64Array,
  at: number,
  result: Float64Array,
): void {
  const largest = Math.max(
    Math.abs(rotations[at]),
    Math.abs(rotations[at + 1]),
    Math.abs(rotations[at + 2]),
    Math.abs(rotations[at + 3]),
  );
  if (largest === 0) {
    result[0] = 1;
    result[1] = result[2] = result[3] = 0;
    return;
  }
  // Scaled first, so that neither 1e-20 nor 1e20 leaves the range when squared.
  let length2 = 0;
  for (let k = 0; k < 4; k++) {
    result[k] = rotations[at + k] / largest;
    length2 += result[k] * result[k];
  }
  const inverse = 1 / Math.sqrt(length2);
  for (let k = 0; k < 4; k++) result[k] *= inverse;
}

/** Place of the component that is farthest from 0; the first of several. */
export function largestComponent(rotation: Float64Array): number {
  let largest = 0;
  for (let k = 1; k < 4; k++) if (Math.abs(rotation[k]) > Math.abs(rotation[largest])) largest = k;
  return largest;
}

/** The product of two quaternions. `multiplyQuaternions` is the same: in pages, its chunk loads without an engine. */
export function productOf(a: ArrayLike<number>, b: ArrayLike<number>): [number, number, number, number] {
  return [
    a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
    a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
    a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
    a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
  ];
}
