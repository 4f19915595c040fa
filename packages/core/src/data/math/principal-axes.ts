/** Cyclic sweeps converge quadratically: for matrices of some dozens of rows, 6 to 10 suffice. */
const MOST_SWEEPS = 30;

/**
 * Eigenvectors of a symmetric matrix by Jacobi rotations: n orthonormal rows of n values, by falling
 * eigenvalue.
 *
 * @param matrix n × n finite values.
 */
export function principalAxes(matrix: Float64Array, n: number): Float64Array {
  const a = matrix.slice();
  const axes = new Float64Array(n * n);
  for (let i = 0; i < n; i++) axes[i * n + i] = 1;
  let total = 0;
  for (const value of a) total += value * value;
  for (let sweep = 0; sweep < MOST_SWEEPS; sweep++) {
    let rest = 0;
    for (let p = 0; p < n; p++) for (let q = p + 1; q < n; q++) rest += a[p * n + q] ** 2;
    if (rest <= total * Number.EPSILON ** 2) break;
    for (let p = 0; p < n; p++) for (let q = p + 1; q < n; q++) rotate(a, axes, n, p, q);
  }
  const order = Array.from({ length: n }, (_, i) => i).sort((i, j) => a[j * n + j] - a[i * n + i] || i - j);
  const sorted = new Float64Array(n * n);
  order.forEach((from, to) => {
    sorted.set(axes.subarray(from * n, (from + 1) * n), to * n);
  });
  return sorted;
}

/** Makes element (p, q) zero. */
function rotate(a: Float64Array, axes: Float64Array, n: number, p: number, q: number): void {
  const apq = a[p * n + q];
  if (apq === 0) return;
  const theta = (a[q * n + q] - a[p * n + p]) / (2 * apq);
  // The smaller of both angles.
  const t = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.sqrt(theta * theta + 1));
  const c = 1 / Math.sqrt(t * t + 1);
  const s = t * c;
  for (let k = 0; k < n; k++) {
    const akp = a[k * n + p];
    const akq = a[k * n + q];
    a[k * n + p] = c * akp - s * akq;
    a[k * n + q] = s * akp + c * akq;
  }
  for (let k = 0; k < n; k++) {
    const apk = a[p * n + k];
    const aqk = a[q * n + k];
    a[p * n + k] = c * apk - s * aqk;
    a[q * n + k] = s * apk + c * aqk;
    const vp = axes[p * n + k];
    const vq = axes[q * n + k];
    axes[p * n + k] = c * vp - s * vq;
    axes[q * n + k] = s * vp + c * vq;
  }
}
