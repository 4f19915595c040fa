/** Through the corners of an icosahedron: means over these are nearly means over all directions. */
const DIRECTIONS = /* @__PURE__ */ directions();
/** Makes the series of `coverOf` 1 for an opacity of 1. */
const SERIES_START = /* @__PURE__ */ 1 - Math.log(1.5) - 1 / 54;

function directions(): Float64Array {
  const golden = (1 + Math.sqrt(5)) / 2;
  const short = 1 / Math.hypot(1, golden);
  const long = golden * short;
  return Float64Array.of(
    ...[0, short, long, short, long, 0, long, 0, short],
    ...[0, short, -long, short, -long, 0, -long, 0, short],
  );
}

/**
 * Area that a stack covers, in areas of an opaque splat of its shape: its opacity up to 1, above that
 * about the harmonic number (lib/merged-splat.wgsl).
 */
export function coverOf(opacity: number): number {
  const x = opacity + 0.5;
  return opacity <= 1 ? opacity : Math.log(x) + 1 / (24 * x * x) + SERIES_START;
}

/** The opacity that covers as much. */
export function opacityOfCover(cover: number): number {
  if (cover <= 1) return cover;
  const logarithm = cover - SERIES_START;
  const first = Math.exp(logarithm);
  let x = first - 1 / (24 * first);
  // Newton's method.
  for (let step = 0; step < 3; step++)
    x -= (Math.log(x) + 1 / (24 * x * x) - logarithm) / (1 / x - 1 / (12 * x ** 3));
  return Math.max(1, x - 0.5);
}

/**
 * Mean area of an ellipsoid seen along the directions, over 2π.
 *
 * @param axes unit vectors x, y, z, one after another. @param scale standard deviation along each.
 */
export function meanFootprint(axes: ArrayLike<number>, scale: ArrayLike<number>): number {
  let sum = 0;
  for (let at = 0; at < DIRECTIONS.length; at += 3) {
    let squared = 0;
    for (let axis = 0; axis < 3; axis++) {
      const along =
        axes[3 * axis] * DIRECTIONS[at] +
        axes[3 * axis + 1] * DIRECTIONS[at + 1] +
        axes[3 * axis + 2] * DIRECTIONS[at + 2];
      squared += (along * scale[(axis + 1) % 3] * scale[(axis + 2) % 3]) ** 2;
    }
    sum += Math.sqrt(squared);
  }
  return (3 * sum) / DIRECTIONS.length;
}

/** Areas of a Gaussian seen along the directions, over 2π; `at` is the place of xx, yy, zz, yz, xz, xy. */
function footprints(values: Float64Array, at: number, areas: Float64Array): void {
  const xx = values[at];
  const yy = values[at + 1];
  const zz = values[at + 2];
  const yz = values[at + 3];
  const xz = values[at + 4];
  const xy = values[at + 5];
  for (let i = 0; i < areas.length; i++) {
    const x = DIRECTIONS[3 * i];
    const y = DIRECTIONS[3 * i + 1];
    const z = DIRECTIONS[3 * i + 2];
    const diagonal = x * x * (yy * zz - yz * yz) + y * y * (xx * zz - xz * xz) + z * z * (xx * yy - xy * xy);
    const rest = y * z * (xy * xz - xx * yz) + x * z * (xy * yz - yy * xz) + x * y * (xz * yz - zz * xy);
    areas[i] = Math.sqrt(Math.max(0, diagonal + 2 * rest));
  }
}

/** A Gaussian among others in one array. */
interface PlacedGaussian {
  /** Area that it covers, over 2π, on average over directions. */
  readonly weight: number;
  /** Places in the array of x, y, z, and of its covariance: xx, yy, zz, yz, xz, xy. */
  readonly centerAt: number;
  readonly covarianceAt: number;
}

/** Computes the area that two Gaussians both cover; its arrays serve one pair after another. */
export class Overlap {
  readonly #sum = new Float64Array(6);
  readonly #ofA = new Float64Array(DIRECTIONS.length / 3);
  readonly #ofB = new Float64Array(DIRECTIONS.length / 3);
  readonly #ofBoth = new Float64Array(DIRECTIONS.length / 3);

  /** Area that both cover, over 2π, on average over directions: see lib/merged-splat.wgsl. */
  of(values: Float64Array, a: PlacedGaussian, b: PlacedGaussian): number {
    const sum = this.#sum;
    for (let k = 0; k < 6; k++) sum[k] = values[a.covarianceAt + k] + values[b.covarianceAt + k];
    footprints(values, a.covarianceAt, this.#ofA);
    footprints(values, b.covarianceAt, this.#ofB);
    footprints(sum, 0, this.#ofBoth);
    let [sumA, sumB] = [0, 0];
    const count = this.#ofBoth.length;
    for (let i = 0; i < count; i++) {
      sumA += this.#ofA[i];
      sumB += this.#ofB[i];
    }
    // Nothing that has no area covers anything twice.
    if (sumA === 0 || sumB === 0) return 0;
    const dx = values[a.centerAt] - values[b.centerAt];
    const dy = values[a.centerAt + 1] - values[b.centerAt + 1];
    const dz = values[a.centerAt + 2] - values[b.centerAt + 2];
    let overlap = 0;
    for (let i = 0; i < count; i++) {
      const both = this.#ofBoth[i];
      if (both === 0) continue;
      const areaA = (count * a.weight * this.#ofA[i]) / sumA;
      const areaB = (count * b.weight * this.#ofB[i]) / sumB;
      const nx = DIRECTIONS[3 * i];
      const ny = DIRECTIONS[3 * i + 1];
      const nz = DIRECTIONS[3 * i + 2];
      const x = (ny * dz - nz * dy) / both;
      const y = (nz * dx - nx * dz) / both;
      const z = (nx * dy - ny * dx) / both;
      const squared =
        sum[0] * x * x +
        sum[1] * y * y +
        sum[2] * z * z +
        2 * (sum[3] * y * z + sum[4] * x * z + sum[5] * x * y);
      overlap += Math.min(areaA * (areaB / both) * Math.exp(-0.5 * squared), areaA, areaB);
    }
    return overlap / count;
  }
}
