import { shRestBasis } from './spherical-harmonics.ts';
import type { ShDegree } from './splat-set.ts';

/**
 * Gauss–Legendre nodes and weights of four points on −1…1: with eight turns, exact for products of
 * two functions of degree 3.
 */
const NODES: readonly (readonly [z: number, weight: number])[] = [-1, 1].flatMap((sign) => {
  const root = (2 / 7) * Math.sqrt(6 / 5);
  return [
    [Math.sqrt(3 / 7 - root), (18 + Math.sqrt(30)) / 36] as const,
    [Math.sqrt(3 / 7 + root), (18 - Math.sqrt(30)) / 36] as const,
  ].map(([z, weight]) => [sign * z, weight] as const);
});
const TURNS = 8;

/**
 * Turns the colours of splats along with the splats: harmonics are functions of a direction, and a
 * function of one degree that is turned is one of the same degree. Mirrors are as exact as
 * rotations.
 */
export class HarmonicsTurn {
  /** For each degree from 1 on, a matrix of 2l + 1 rows. */
  readonly #matrices: readonly Float64Array[];
  readonly #before = new Float64Array(7 * 3);

  /** @param turn orthogonal 3×3 matrix, column-major. */
  constructor(degree: ShDegree, turn: ArrayLike<number>) {
    const matrices = Array.from({ length: degree }, (_, i) => new Float64Array((2 * i + 3) ** 2));
    for (const [z, weight] of NODES) {
      for (let i = 0; i < TURNS; i++) {
        const angle = (2 * Math.PI * i) / TURNS;
        const radius = Math.sqrt(1 - z * z);
        const x = radius * Math.cos(angle);
        const y = radius * Math.sin(angle);
        const after = shRestBasis(degree, x, y, z);
        // The direction before the turn: its transpose undoes it.
        const before = shRestBasis(
          degree,
          turn[0] * x + turn[1] * y + turn[2] * z,
          turn[3] * x + turn[4] * y + turn[5] * z,
          turn[6] * x + turn[7] * y + turn[8] * z,
        );
        addProducts(matrices, after, before, (weight * 2 * Math.PI) / TURNS);
      }
    }
    this.#matrices = matrices;
  }

  /** Turns the coefficients of one splat above degree 0, each as r, g, b, from `at` on. */
  apply(values: Float32Array, at: number): void {
    const before = this.#before;
    let start = at;
    for (const matrix of this.#matrices) {
      const size = Math.sqrt(matrix.length);
      for (let i = 0; i < 3 * size; i++) before[i] = values[start + i];
      for (let row = 0; row < size; row++) {
        let red = 0;
        let green = 0;
        let blue = 0;
        for (let k = 0; k < size; k++) {
          const factor = matrix[row * size + k];
          red += factor * before[3 * k];
          green += factor * before[3 * k + 1];
          blue += factor * before[3 * k + 2];
        }
        values[start + 3 * row] = red;
        values[start + 3 * row + 1] = green;
        values[start + 3 * row + 2] = blue;
      }
      start += 3 * size;
    }
  }
}

/** Adds to each degree's matrix one point of ∫ Yₘ(d) Yₙ(turn⁻¹ d). */
function addProducts(
  matrices: readonly Float64Array[],
  after: readonly number[],
  before: readonly number[],
  weight: number,
): void {
  let first = 0;
  for (const matrix of matrices) {
    const size = Math.sqrt(matrix.length);
    for (let row = 0; row < size; row++) {
      for (let k = 0; k < size; k++)
        matrix[row * size + k] += weight * after[first + row] * before[first + k];
    }
    first += size;
  }
}
