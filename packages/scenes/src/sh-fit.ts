/**
 * Fits radiance as a function of the viewing direction into real spherical harmonics, in the basis and with the signs
 * that Gaussian-splat scenes are trained in: colour = max(0, 0.5 + Σ c·Y(d)), d from the camera to the splat.
 */
import type { ShDegree } from '@websplatter/core';

const C0 = 0.28209479177387814;
const C1 = 0.4886025119029199;
const C2 = [
  1.0925484305920792, -1.0925484305920792, 0.31539156525252005, -1.0925484305920792, 0.5462742152960396,
];
const C3 = [
  -0.5900435899266435, 2.890611442640554, -0.4570457994644658, 0.3731763325901154, -0.4570457994644658,
  1.445305721320277, -0.5900435899266435,
];

/** The basis function of degree 0, a constant. */
export const SH_C0 = C0;

/** Basis functions up to and including `degree`: 1, 4, 9, 16. */
export function shBasisSize(degree: ShDegree): number {
  return (degree + 1) ** 2;
}

/** Writes the basis functions up to `degree` at the unit direction (x, y, z) into `basis`. */
export function evaluateShBasis(
  degree: ShDegree,
  x: number,
  y: number,
  z: number,
  basis: Float64Array,
): void {
  basis[0] = C0;
  if (degree < 1) return;
  basis[1] = -C1 * y;
  basis[2] = C1 * z;
  basis[3] = -C1 * x;
  if (degree < 2) return;
  const xx = x * x;
  const yy = y * y;
  const zz = z * z;
  basis[4] = C2[0] * x * y;
  basis[5] = C2[1] * y * z;
  basis[6] = C2[2] * (2 * zz - xx - yy);
  basis[7] = C2[3] * x * z;
  basis[8] = C2[4] * (xx - yy);
  if (degree < 3) return;
  basis[9] = C3[0] * y * (3 * xx - yy);
  basis[10] = C3[1] * x * y * z;
  basis[11] = C3[2] * y * (4 * zz - xx - yy);
  basis[12] = C3[3] * z * (2 * zz - 3 * xx - 3 * yy);
  basis[13] = C3[4] * x * (4 * zz - xx - yy);
  basis[14] = C3[5] * z * (xx - yy);
  basis[15] = C3[6] * x * (xx - 3 * yy);
}

const GOLDEN_RATIO = (1 + Math.sqrt(5)) / 2;

/** `count` unit directions, evenly spread over the part of the sphere with z above `lowestZ`; x, y, z each. */
export function fibonacciDirections(count: number, lowestZ: number): Float64Array {
  const directions = new Float64Array(3 * count);
  for (let i = 0; i < count; i++) {
    const z = 1 - ((i + 0.5) / count) * (1 - lowestZ);
    const radius = Math.sqrt(1 - z * z);
    const angle = (2 * Math.PI * i) / GOLDEN_RATIO;
    directions[3 * i] = radius * Math.cos(angle);
    directions[3 * i + 1] = radius * Math.sin(angle);
    directions[3 * i + 2] = z;
  }
  return directions;
}

/**
 * (BᵀB/n + ridge)⁻¹Bᵀ/n as size × n, row by row, for the n directions' basis B. The ridge grows as (l(l+1))²
 * (the smoothness penalty of the sphere's Laplacian), so that detail is only spent where the samples ask for it.
 * In the `calm` directions, where there are no samples, everything but the mean is held near zero.
 */
function pseudoInverse(
  degree: ShDegree,
  directions: Float64Array,
  ridge: number,
  calm: Float64Array,
): Float64Array {
  const size = shBasisSize(degree);
  const count = directions.length / 3;
  const basis = new Float64Array(size);
  const rows = new Float64Array(count * size);
  const normal = new Float64Array(size * size);
  for (let i = 0; i < count; i++) {
    evaluateShBasis(degree, directions[3 * i], directions[3 * i + 1], directions[3 * i + 2], basis);
    rows.set(basis, i * size);
    for (let j = 0; j < size; j++) {
      for (let k = 0; k < size; k++) normal[j * size + k] += (basis[j] * basis[k]) / count;
    }
  }
  for (let j = 0; j < size; j++) {
    const band = Math.floor(Math.sqrt(j));
    normal[j * size + j] += ridge * (band * (band + 1)) ** 2;
  }
  for (let i = 0; i < calm.length / 3; i++) {
    evaluateShBasis(degree, calm[3 * i], calm[3 * i + 1], calm[3 * i + 2], basis);
    const weight = (3 * CALM_WEIGHT) / calm.length;
    for (let j = 1; j < size; j++) {
      for (let k = 1; k < size; k++) normal[j * size + k] += weight * basis[j] * basis[k];
    }
  }
  const inverse = invertPositiveDefinite(normal, size);
  const result = new Float64Array(size * count);
  for (let j = 0; j < size; j++) {
    for (let i = 0; i < count; i++) {
      let sum = 0;
      for (let k = 0; k < size; k++) sum += inverse[j * size + k] * rows[i * size + k];
      result[j * count + i] = sum / count;
    }
  }
  return result;
}

/** Gauss–Jordan without pivoting, which a symmetric positive definite matrix does not need. */
function invertPositiveDefinite(matrix: Float64Array, size: number): Float64Array {
  const work = matrix.slice();
  const inverse = new Float64Array(size * size);
  for (let i = 0; i < size; i++) inverse[i * size + i] = 1;
  for (let column = 0; column < size; column++) {
    const pivot = 1 / work[column * size + column];
    for (let k = 0; k < size; k++) {
      work[column * size + k] *= pivot;
      inverse[column * size + k] *= pivot;
    }
    for (let row = 0; row < size; row++) {
      if (row === column) continue;
      const factor = work[row * size + column];
      for (let k = 0; k < size; k++) {
        work[row * size + k] -= factor * work[column * size + k];
        inverse[row * size + k] -= factor * inverse[column * size + k];
      }
    }
  }
  return inverse;
}

/** Samples per fit: four per coefficient of degree 3, enough to average a highlight's edge. */
export const FIT_DIRECTIONS = 64;

/** Weak smoothing: highlights are to stay as sharp as degree 3 allows. */
const FIT_RIDGE = 2e-5;

/**
 * Weight of the hemisphere behind a surface against its front. Free there, the fit runs to several times white, which
 * then gleams through the gaps of whatever hides the surface's back.
 */
const CALM_WEIGHT = 0.015;
const CALM_DIRECTIONS = 40;
/** Calm from a little behind the last sample on. */
const CALM_LOWEST_Z = 0.25;

/** A little over the hemisphere: a splat's neighbours' normals differ, so that it is seen from just behind too. */
const HEMISPHERE_LOWEST_Z = -0.12;

/** Directions that the rotation into world space resamples at; more than 16, for a well-conditioned inverse. */
const RESAMPLE_DIRECTIONS = 24;

/**
 * Fits samples of displayed colour in a local frame and turns the result into world space. `views` are unit vectors
 * from the surface **towards** the camera, in a frame whose z is the normal.
 */
export class ShFit {
  readonly degree: ShDegree;
  /** 3·FIT_DIRECTIONS: where to sample, local frame, towards the camera. */
  readonly views: Float64Array;
  readonly #inverse: Float64Array;
  readonly #resampleDirections: Float64Array;
  readonly #resampleInverse: Float64Array;
  readonly #size: number;
  readonly #local: Float64Array;
  readonly #basis: Float64Array;

  /** `side`: a closed surface is only seen from its front, a thin or translucent one from both sides. */
  constructor(degree: ShDegree, side: 'front' | 'both') {
    this.degree = degree;
    this.views = fibonacciDirections(FIT_DIRECTIONS, side === 'front' ? HEMISPHERE_LOWEST_Z : -1);
    const directions = this.views.map((component) => -component);
    // Directions are camera → splat: seen from behind the surface they lie around +z.
    const calm = side === 'front' ? fibonacciDirections(CALM_DIRECTIONS, CALM_LOWEST_Z) : new Float64Array(0);
    this.#inverse = pseudoInverse(degree, directions, FIT_RIDGE, calm);
    this.#resampleDirections = fibonacciDirections(RESAMPLE_DIRECTIONS, -1);
    this.#resampleInverse = pseudoInverse(degree, this.#resampleDirections, 0, new Float64Array(0));
    this.#size = shBasisSize(degree);
    this.#local = new Float64Array(3 * this.#size);
    this.#basis = new Float64Array(this.#size);
  }

  /**
   * @param samples 3·FIT_DIRECTIONS displayed (sRGB-encoded) colours, one per view
   * @param frame nine numbers: the local x, y and z axes in world space, orthonormal
   * @param coefficients receives 3·(degree+1)² values, r, g, b per basis function, for d = camera → splat
   */
  fit(samples: Float64Array, frame: Float64Array, coefficients: Float64Array): void {
    const size = this.#size;
    const local = this.#local;
    const inverse = this.#inverse;
    for (let j = 0; j < size; j++) {
      let r = 0;
      let g = 0;
      let b = 0;
      const row = j * FIT_DIRECTIONS;
      for (let i = 0; i < FIT_DIRECTIONS; i++) {
        const weight = inverse[row + i];
        r += weight * (samples[3 * i] - 0.5);
        g += weight * (samples[3 * i + 1] - 0.5);
        b += weight * (samples[3 * i + 2] - 0.5);
      }
      local[3 * j] = r;
      local[3 * j + 1] = g;
      local[3 * j + 2] = b;
    }
    this.#rotate(frame, coefficients);
  }

  /**
   * A rotation keeps a function within its bands, so evaluating it at enough directions and solving for the
   * coefficients again is exact, and needs no Wigner matrices.
   */
  #rotate(frame: Float64Array, coefficients: Float64Array): void {
    const size = this.#size;
    const local = this.#local;
    const basis = this.#basis;
    const directions = this.#resampleDirections;
    const inverse = this.#resampleInverse;
    coefficients.fill(0, 0, 3 * size);
    for (let i = 0; i < RESAMPLE_DIRECTIONS; i++) {
      const x = directions[3 * i];
      const y = directions[3 * i + 1];
      const z = directions[3 * i + 2];
      evaluateShBasis(
        this.degree,
        frame[0] * x + frame[1] * y + frame[2] * z,
        frame[3] * x + frame[4] * y + frame[5] * z,
        frame[6] * x + frame[7] * y + frame[8] * z,
        basis,
      );
      let r = 0;
      let g = 0;
      let b = 0;
      for (let j = 0; j < size; j++) {
        r += basis[j] * local[3 * j];
        g += basis[j] * local[3 * j + 1];
        b += basis[j] * local[3 * j + 2];
      }
      for (let j = 0; j < size; j++) {
        const weight = inverse[j * RESAMPLE_DIRECTIONS + i];
        coefficients[3 * j] += weight * r;
        coefficients[3 * j + 1] += weight * g;
        coefficients[3 * j + 2] += weight * b;
      }
    }
  }
}
