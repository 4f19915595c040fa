import { CHUNK_SPLATS } from '../layout/constants.ts';
import { LEVEL_CONSTANTS } from '../layout/level-structs.ts';
import { principalAxes } from '../math/principal-axes.ts';
import { quaternionOfAxes } from '../math/quaternion-of-axes.ts';
import { writeRotationMatrix } from '../math/rotation-matrix.ts';
import { normalizedRotation } from '../packing/rotation.ts';
import { emptySplat, type UnpackedSplat } from '../packing/unpack-geometry.ts';
import { coverOf, meanFootprint, Overlap, opacityOfCover } from './covered-area.ts';

const { CELL_ROOTS, ERROR_BOUNDLESS, ERROR_SHIFT, MERGED_RADIUS, MOST_OPACITY } = LEVEL_CONSTANTS;

/** Places of a node's values: centre and colour take three each, variances and covariances, too. */
const [CENTER, WEIGHT, VARIANCE, COVARIANCE, TRACE, COLOR, RIM, OPACITY, WIDTH] = [
  0, 3, 4, 7, 10, 11, 14, 15, 16,
];
/** Exponent of Thomsen's formula. */
const THOMSEN = 1.6075;
const LEAST_OPACITY = 1e-6;
/** Spherical harmonics of degree 0, squared. */
const COLOR_OF_DC_2 = 0.28209479177387814 ** 2;
/** As in lib/merged-splat.wgsl. */
const COLOR_COST = 3;
const SHAPE_COST = 0.25;
/** Differences of shapes below this part of their extent cost nothing: rounding leaves as much. */
const SHAPE_ROUNDING = 1e-6;
/** Half axes of a root are at least this part of its longest: rounding may leave less than 0. */
const THINNEST = 1e-15;

const f32 = new Float32Array(1);
const f32Bits = new Uint32Array(f32.buffer);

/**
 * Returns the code of an error in a link of levels of detail (shaders/lib/level-link.wgsl): the upper
 * bits of its float32, rounded up, and at least 1.
 *
 * @param squaredLength the square of the error, in the units of positions.
 */
function errorCode(squaredLength: number): number {
  f32[0] = squaredLength;
  const code = Math.floor((f32Bits[0] + 2 ** ERROR_SHIFT - 1) / 2 ** ERROR_SHIFT);
  return Math.max(1, Math.min(code, ERROR_BOUNDLESS - 1));
}

/** A leaf of a cell, or a root: values as drawn, in the scene's units. */
export interface MergedLeaf<Values extends Float64Array | Float32Array = Float64Array>
  extends UnpackedSplat<Values> {
  /** Sums over its splats: opacity times rim length, and opacity. Read of blobs only. */
  readonly sums: Values;
}

export function emptyLeaf(): MergedLeaf {
  return { ...emptySplat(), sums: new Float64Array(2) };
}

/**
 * Merges the leaves of one cell after another into at most sixteen roots, in float64: the same
 * nodes as stages/merge/merge-chunks.wgsl. Nodes are numbers in arrays that are used again, since
 * scenes have as many of them as splats. Reference: stages/merge/merge.reference.ts.
 */
export class CellMerger {
  readonly #nodes = new Float64Array(WIDTH * CHUNK_SPLATS);
  readonly #errors = new Uint16Array(CHUNK_SPLATS);
  /** The leaf whose node has taken in a leaf's; itself where none has. */
  readonly #into = new Uint16Array(CHUNK_SPLATS);
  /** Leaves that have nodes, in order. Roots, once merged. */
  readonly #order = new Uint16Array(CHUNK_SPLATS);
  /** By place in the order. */
  readonly #nearest = new Uint16Array(CHUNK_SPLATS);
  readonly #leastCosts = new Float64Array(CHUNK_SPLATS);
  readonly #rootOfLeaf = new Uint8Array(CHUNK_SPLATS);
  /** Pairs that merged, in order: the leaves of both, and the first one's share of the weight. */
  readonly #firsts = new Uint16Array(CHUNK_SPLATS);
  readonly #seconds = new Uint16Array(CHUNK_SPLATS);
  readonly #firstShares = new Float64Array(CHUNK_SPLATS);
  #pairCount = 0;
  /** A leaf's share of its root. */
  readonly #shares = new Float64Array(CHUNK_SPLATS);
  readonly #overlap = new Overlap();
  readonly #axes = new Float64Array(9);
  #leafCount = 0;
  #rootCount = 0;

  /** Begins a cell. */
  begin(): void {
    this.#leafCount = 0;
    this.#rootCount = 0;
    this.#pairCount = 0;
  }

  /** Adds the next leaf. @param error of a blob's cell, 0 of a splat, whose `sums` are not read. */
  add({ position, opacity, rotation, scale, colorDc, sums }: MergedLeaf, error: number): void {
    const leaf = this.#leafCount++;
    const n = this.#nodes;
    const at = leaf * WIDTH;
    const axes = this.#axes;
    writeRotationMatrix(rotation, axes);
    n.fill(0, at + VARIANCE, at + TRACE);
    for (let k = 0; k < 3; k++) addOuter(n, at, scale[k], axes[3 * k], axes[3 * k + 1], axes[3 * k + 2]);
    n[at + TRACE] = n[at + VARIANCE] + n[at + VARIANCE + 1] + n[at + VARIANCE + 2];
    n[at + WEIGHT] = coverOf(Math.max(opacity, LEAST_OPACITY)) * meanFootprint(axes, scale);
    for (let k = 0; k < 3; k++) {
      n[at + CENTER + k] = position[k];
      n[at + COLOR + k] = colorDc[k];
    }
    const longest = Math.max(scale[0], scale[1], scale[2]);
    const isSplat = error === 0;
    const area = isSplat ? meanArea(scale[0], scale[1], scale[2]) : 0;
    n[at + RIM] = isSplat ? opacity * Math.max(0, longest - area / longest) : sums[0];
    n[at + OPACITY] = isSplat ? opacity : sums[1];
    this.#errors[leaf] = error;
    this.#into[leaf] = leaf;
    this.#order[leaf] = leaf;
  }

  /** Merges the leaves that were added. Returns how many roots there are, 1 to 16. */
  merge(): number {
    let count = this.#leafCount;
    const order = this.#order;
    while (count > CELL_ROOTS) {
      this.#findNearest(count);
      let spare = count - CELL_ROOTS;
      for (let place = 0; place < count && spare > 0; place++) {
        const other = this.#nearest[place];
        if (other <= place || this.#nearest[other] !== place) continue;
        this.#merge(order[place], order[other], this.#leastCosts[place]);
        spare--;
      }
      // Costs that overflow are no numbers, of which none is the least.
      if (spare === count - CELL_ROOTS) this.#merge(order[0], order[1], 0);
      let kept = 0;
      for (let place = 0; place < count; place++)
        if (this.#into[order[place]] === order[place]) order[kept++] = order[place];
      count = kept;
    }
    this.#rootCount = count;
    for (let root = 0; root < count; root++) {
      this.#rootOfLeaf[order[root]] = root;
      this.#errors[order[root]] = Math.max(1, this.#errors[order[root]]);
    }
    // A node goes into one of a smaller leaf, whose root is known by then.
    for (let leaf = 0; leaf < this.#leafCount; leaf++)
      this.#rootOfLeaf[leaf] = this.#rootOfLeaf[this.#into[leaf]];
    // Backwards, from roots to leaves.
    this.#shares.fill(1, 0, this.#leafCount);
    for (let pair = this.#pairCount - 1; pair >= 0; pair--) {
      const [first, second] = [this.#firsts[pair], this.#seconds[pair]];
      this.#shares[second] = this.#shares[first] * (1 - this.#firstShares[pair]);
      this.#shares[first] *= this.#firstShares[pair];
    }
    return count;
  }

  /** Error of the cell: the largest error of its roots, 1 to 4094. */
  get error(): number {
    let error = 0;
    for (let root = 0; root < this.#rootCount; root++)
      error = Math.max(error, this.#errors[this.#order[root]]);
    return error;
  }

  /** Which root stands for a leaf; roots are in the order of their first leaves. */
  rootOf(leaf: number): number {
    return this.#rootOfLeaf[leaf];
  }

  /** A leaf's part in the means of its root, 0 to 1. */
  shareOf(leaf: number): number {
    return this.#shares[leaf];
  }

  /** Writes a root as the leaf that it is of the cell above. */
  root(root: number, result: MergedLeaf): void {
    const n = this.#nodes;
    const at = this.#order[root] * WIDTH;
    const [xx, yy, zz, yz, xz, xy] = n.subarray(at + VARIANCE, at + VARIANCE + 6);
    const axes = principalAxes(Float64Array.of(xx, xy, xz, xy, yy, yz, xz, yz, zz), 3);
    let longest = 0;
    for (let k = 0; k < 3; k++) {
      const [x, y, z] = axes.subarray(3 * k, 3 * k + 3);
      const variance = x * (x * xx + 2 * y * xy + 2 * z * xz) + y * (y * yy + 2 * z * yz) + z * z * zz;
      const scale = Math.sqrt(Math.max(0, variance));
      longest = Math.max(longest, scale);
      result.scale[k] = Math.max(scale, THINNEST * longest);
      result.position[k] = n[at + CENTER + k];
      result.colorDc[k] = n[at + COLOR + k];
    }
    normalizedRotation(Float64Array.from(quaternionOfAxes(axes)), 0, result.rotation);
    const cover = n[at + WEIGHT] / meanFootprint(axes, result.scale);
    result.opacity = Math.min(opacityOfCover(cover), MOST_OPACITY);
    result.sums[0] = n[at + RIM];
    result.sums[1] = n[at + OPACITY];
  }

  /** Finds, for each place, the one that costs least to merge with; the first of equal ones. */
  #findNearest(count: number): void {
    const least = this.#leastCosts.fill(Number.POSITIVE_INFINITY, 0, count);
    const nearest = this.#nearest;
    for (let place = 0; place < count; place++) nearest[place] = place;
    for (let place = 0; place < count; place++) {
      const last = Math.min(place + MERGED_RADIUS, count - 1);
      for (let other = place + 1; other <= last; other++) {
        const cost = this.#costOf(this.#order[place] * WIDTH, this.#order[other] * WIDTH);
        if (cost < least[place]) {
          least[place] = cost;
          nearest[place] = other;
        }
        if (cost < least[other]) {
          least[other] = cost;
          nearest[other] = place;
        }
      }
    }
  }

  /** Ward's cost of two nodes: see `mergeCost` of lib/merged-splat.wgsl. */
  #costOf(a: number, b: number): number {
    const n = this.#nodes;
    const weight = n[a + WEIGHT] + n[b + WEIGHT];
    const share = n[a + WEIGHT] / weight;
    const moved = share * (1 - share);
    const x = n[a] - n[b];
    const y = n[a + 1] - n[b + 1];
    const z = n[a + 2] - n[b + 2];
    const red = n[a + COLOR] - n[b + COLOR];
    const green = n[a + COLOR + 1] - n[b + COLOR + 1];
    const blue = n[a + COLOR + 2] - n[b + COLOR + 2];
    const distance2 = x * x + y * y + z * z;
    const contrast2 = COLOR_OF_DC_2 * (red * red + green * green + blue * blue);
    const trace = share * n[a + TRACE] + (1 - share) * n[b + TRACE] + moved * distance2;
    // Written out, because this is most of the work of a conversion.
    const xx = n[a + VARIANCE] - n[b + VARIANCE];
    const yy = n[a + VARIANCE + 1] - n[b + VARIANCE + 1];
    const zz = n[a + VARIANCE + 2] - n[b + VARIANCE + 2];
    const yz = n[a + COVARIANCE] - n[b + COVARIANCE];
    const xz = n[a + COVARIANCE + 1] - n[b + COVARIANCE + 1];
    const xy = n[a + COVARIANCE + 2] - n[b + COVARIANCE + 2];
    const shapes2 = xx * xx + yy * yy + zz * zz + 2 * (yz * yz + xz * xz + xy * xy);
    const shapes = Math.max(0, Math.sqrt(shapes2) - SHAPE_ROUNDING * trace);
    const apart2 = distance2 + COLOR_COST * trace * contrast2 + SHAPE_COST * shapes;
    return 4 * Math.PI * weight * moved * apart2;
  }

  /** Makes the node of leaf `first` the Gaussian of both. */
  #merge(first: number, second: number, cost: number): void {
    const n = this.#nodes;
    const [a, b] = [first * WIDTH, second * WIDTH];
    const weight = n[a + WEIGHT] + n[b + WEIGHT];
    const share = n[a + WEIGHT] / weight;
    const rest = 1 - share;
    const moved = share * rest;
    const x = n[a] - n[b];
    const y = n[a + 1] - n[b + 1];
    const z = n[a + 2] - n[b + 2];
    const placed = (at: number) => ({
      weight: n[at + WEIGHT],
      centerAt: at + CENTER,
      covarianceAt: at + VARIANCE,
    });
    const overlap = this.#overlap.of(n, placed(a), placed(b));
    for (let k = VARIANCE; k < RIM; k++) n[a + k] = share * n[a + k] + rest * n[b + k];
    for (let k = CENTER; k < WEIGHT; k++) n[a + k] = share * n[a + k] + rest * n[b + k];
    n[a + VARIANCE] += moved * x * x;
    n[a + VARIANCE + 1] += moved * y * y;
    n[a + VARIANCE + 2] += moved * z * z;
    n[a + COVARIANCE] += moved * y * z;
    n[a + COVARIANCE + 1] += moved * x * z;
    n[a + COVARIANCE + 2] += moved * x * y;
    n[a + TRACE] = n[a + VARIANCE] + n[a + VARIANCE + 1] + n[a + VARIANCE + 2];
    n[a + WEIGHT] = weight - overlap;
    n[a + RIM] += n[b + RIM];
    n[a + OPACITY] += n[b + OPACITY];
    const errors = this.#errors;
    errors[first] = Math.max(errorCode(Math.sqrt(cost)), errors[first], errors[second]);
    this.#into[second] = first;
    const pair = this.#pairCount++;
    this.#firsts[pair] = first;
    this.#seconds[pair] = second;
    this.#firstShares[pair] = share;
  }
}

/** Mean area of an ellipsoid's projections over π, by Thomsen's formula, of its half axes. */
function meanArea(a: number, b: number, c: number): number {
  const mean = ((a * b) ** THOMSEN + (a * c) ** THOMSEN + (b * c) ** THOMSEN) / 3;
  return mean ** (1 / THOMSEN);
}

/** Adds the square of an axis of this length along x, y, z to the covariance of the node at `at`. */
function addOuter(n: Float64Array, at: number, length: number, x: number, y: number, z: number): void {
  const squared = length * length;
  n[at + VARIANCE] += squared * x * x;
  n[at + VARIANCE + 1] += squared * y * y;
  n[at + VARIANCE + 2] += squared * z * z;
  n[at + COVARIANCE] += squared * y * z;
  n[at + COVARIANCE + 1] += squared * x * z;
  n[at + COVARIANCE + 2] += squared * x * y;
}
