/** Writes the column-major 3×3 matrix of a unit quaternion w, x, y, z: the splat's axes. */
export function writeRotationMatrix(unit: Float64Array, result: Float64Array): void {
  // By index: taking apart a typed array takes longer than all else here.
  const w = unit[0];
  const x = unit[1];
  const y = unit[2];
  const z = unit[3];
  result[0] = 1 - 2 * (y * y + z * z);
  result[1] = 2 * (x * y + w * z);
  result[2] = 2 * (x * z - w * y);
  result[3] = 2 * (x * y - w * z);
  result[4] = 1 - 2 * (x * x + z * z);
  result[5] = 2 * (y * z + w * x);
  result[6] = 2 * (x * z + w * y);
  result[7] = 2 * (y * z - w * x);
  result[8] = 1 - 2 * (x * x + y * y);
}
