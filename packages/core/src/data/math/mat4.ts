/** A 4×4 matrix of float64, column-major: element (row r, column c) is at 4c + r. */
export type Mat4 = Float64Array;

/** A 3×3 matrix of float64, column-major. An array, which V8 allocates faster than 72 typed bytes. */
export type Mat3 = readonly number[];

/** x, y and z. */
export type Vec3 = readonly [number, number, number];

export function identity4(): Mat4 {
  return Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
}

/**
 * Returns a·b.
 *
 * @param product where to write it: a frame multiplies one for each instance of its clouds.
 */
export function multiply4(a: ArrayLike<number>, b: ArrayLike<number>, product = new Float64Array(16)): Mat4 {
  for (let c = 0; c < 4; c++) {
    for (let r = 0; r < 4; r++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += a[4 * k + r] * b[4 * c + k];
      product[4 * c + r] = sum;
    }
  }
  return product;
}

/** Returns m·T(offset): a translation by `offset`, then `m`. */
export function translated4(m: ArrayLike<number>, offset: Vec3): Mat4 {
  const result = new Float64Array(m);
  for (let r = 0; r < 4; r++) {
    result[12 + r] = m[r] * offset[0] + m[4 + r] * offset[1] + m[8 + r] * offset[2] + m[12 + r];
  }
  return result;
}

/** Returns the upper left 3×3 of `m`, column-major. */
export function linearPart(m: ArrayLike<number>): Mat3 {
  return [m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]];
}

/** Returns the inverse of a 3×3 matrix, or null if it is singular or not finite. */
export function invert3(m: ArrayLike<number>): Mat3 | null {
  // Scaled first, so that the determinant neither overflows nor underflows.
  let largest = 0;
  for (let k = 0; k < 9; k++) largest = Math.max(largest, Math.abs(m[k]));
  if (!(largest > 0) || !Number.isFinite(largest)) return null;
  // Spelled out for speed: it runs for every cloud of every frame.
  const a = m[0] / largest;
  const b = m[1] / largest;
  const c = m[2] / largest;
  const d = m[3] / largest;
  const e = m[4] / largest;
  const f = m[5] / largest;
  const g = m[6] / largest;
  const h = m[7] / largest;
  const i = m[8] / largest;
  const firstRow = e * i - f * h;
  const secondRow = c * h - b * i;
  const thirdRow = b * f - c * e;
  const determinant = a * firstRow + d * secondRow + g * thirdRow;
  if (Math.abs(determinant) < 1e-30) return null;
  const scale = 1 / (determinant * largest);
  return [
    firstRow * scale,
    secondRow * scale,
    thirdRow * scale,
    (f * g - d * i) * scale,
    (a * i - c * g) * scale,
    (c * d - a * f) * scale,
    (d * h - e * g) * scale,
    (b * g - a * h) * scale,
    (a * e - b * d) * scale,
  ];
}

/** Returns m·v for a column-major 3×3 matrix. */
export function transform3(m: ArrayLike<number>, v: ArrayLike<number>): [number, number, number] {
  return [
    m[0] * v[0] + m[3] * v[1] + m[6] * v[2],
    m[1] * v[0] + m[4] * v[1] + m[7] * v[2],
    m[2] * v[0] + m[5] * v[1] + m[8] * v[2],
  ];
}

/** Returns a bound of a column-major 3×3 matrix's stretch of vectors (Frobenius norm). */
export function stretchBound(m: ArrayLike<number>): number {
  let largest = 0;
  for (let k = 0; k < 9; k++) largest = Math.max(largest, Math.abs(m[k]));
  if (largest === 0) return 0;
  // Math.hypot is several times as slow.
  let sum = 0;
  for (let k = 0; k < 9; k++) sum += (m[k] / largest) ** 2;
  return largest * Math.sqrt(sum);
}

/**
 * Whether a column-major 3×3 matrix turns, mirrors and scales all axes alike.
 *
 * @param tolerance of the products of its columns, as a part of the first one's square.
 */
export function scalesEvenly(m: Mat3, tolerance: number): boolean {
  const dot = (a: number, b: number) => m[a] * m[b] + m[a + 1] * m[b + 1] + m[a + 2] * m[b + 2];
  const square = dot(0, 0);
  const isClose = (value: number, expected: number) => Math.abs(value - expected) <= tolerance * square;
  return (
    isClose(dot(3, 3), square) &&
    isClose(dot(6, 6), square) &&
    isClose(dot(0, 3), 0) &&
    isClose(dot(0, 6), 0) &&
    isClose(dot(3, 6), 0)
  );
}
