import { invert3, type Mat3, stretchBound, transform3 } from './mat4.ts';

/** Scaled Newton steps converge quadratically: condition numbers of 1e15 take nine. */
const MOST_STEPS = 24;
const ROUNDING = 4 * Number.EPSILON;

/** A matrix as a stretch along perpendicular axes, followed by a rotation. */
export interface PolarDecomposition {
  /** Orthogonal, column-major 3×3; a mirror if the matrix is one. */
  readonly rotation: Mat3;
  /** Symmetric and positive definite, column-major 3×3. */
  readonly stretch: Mat3;
}

/**
 * Polar decomposition of a column-major 3×3 matrix, m = rotation · stretch; null if it is singular
 * or not finite. The rotation is the orthogonal matrix nearest to m.
 *
 * Newton's method averages a matrix with the transpose of its inverse until both are the same.
 * Source: N. J. Higham, "Computing the polar decomposition", 1986, with its scaling by norms.
 */
export function polarDecomposition(m: Mat3): PolarDecomposition | null {
  let rotation = m;
  for (let step = 0; step < MOST_STEPS; step++) {
    const inverse = invert3(rotation);
    if (!inverse) return null;
    const scale = Math.sqrt(stretchBound(inverse) / stretchBound(rotation));
    const next = rotation.map(
      (value, i) => (scale * value + inverse[3 * (i % 3) + Math.floor(i / 3)] / scale) / 2,
    );
    const change = Math.max(...next.map((value, i) => Math.abs(value - rotation[i])));
    rotation = next;
    if (change <= ROUNDING) break;
  }
  const turned = [0, 3, 6].flatMap((column) => transform3(transposed(rotation), m.slice(column, column + 3)));
  const stretch = turned.map((value, i) => (value + transposed(turned)[i]) / 2);
  return { rotation, stretch };
}

function transposed(m: Mat3): Mat3 {
  return [m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]];
}
