import type { Vec3 } from '../data/math/mat4.ts';
import { cross, dot, unit } from '../data/math/vec3.ts';
import { exp } from './portable-math.ts';
import type { SceneDetail } from './scene-detail.ts';

/** A picture is tried as if its shorter side had so many pixels. */
const SHORTER_SIDE_PX = 600;
/** Drawn area as a multiple of the frame: large splats outside of the frame reach into it. */
const PADDED = 1.5;
/** Cells of the padded picture. */
const LONG_CELLS = 48;
const SHORT_CELLS = 32;
const CELL_PX = (SHORTER_SIDE_PX * PADDED) / SHORT_CELLS;
/** Slices of depth, of equally many splats, which do not hide each other. */
const MOST_SLICES = 24;
const SLICE_SPLATS = 170;
/** Splats are drawn into cells of about their size: 1, 2, 4, 8 or 16 wide. */
const LEVELS = 5;
/** Sharp splats have at most this standard deviation; blurred ones 2³ times as much. */
const SHARP_PX = 4;
const BLURRED_OCTAVES = 3;
/** Area that a splat covers, in products of its standard deviations. */
const AREA = 5;
/** Where detail counts as in the frame: a margin stays free. */
const FRAMED = 0.93;
/** Cells that let less light pass show nothing more. */
const LEAST_TRANSMITTANCE = 1e-3;
/** Nearer than this part of the distance to the target, splats are not drawn. */
const NEAR_PART = 0.02;
/** Bins of depth, 64 of each octave, as float32 has them in its upper bits. */
const DEPTH_SHIFT = 17;
const MOST_BINS = 1 << 11;

/** A camera that is tried, in units of the detail. */
export interface TrialCamera {
  readonly position: Vec3;
  readonly target: Vec3;
}

/** Measures of a coarse trial picture, each 0…1. */
export interface TrialPicture {
  /** Of the detail: in the frame, and unhidden there. */
  readonly framed: number;
  readonly visible: number;
  /** Of the interest: unhidden in the frame. */
  readonly interesting: number;
  /** Of the picture: sharp, sharp with more weight in the middle, blurred behind the target, empty. */
  readonly sharp: number;
  readonly sharpInMiddle: number;
  readonly background: number;
  readonly empty: number;
  /** The rest: blurred in front. */
  readonly fog: number;
  /** Mean depth of the detail that is visible; 0 if none is. */
  readonly depth: number;
}

export interface TrialShape {
  /** Tangents of half the field of view. */
  readonly tangentX: number;
  readonly tangentY: number;
}

/** Draws coarse pictures of a sample of a scene. */
export class TrialViews {
  readonly #count: number;
  readonly #weight: number;
  readonly #columns: readonly Float64Array[];
  readonly #totalDetail: number;
  readonly #totalInterest: number;
  readonly #shape: TrialShape;
  readonly #grid: { readonly columns: number; readonly rows: number };
  readonly #middleWeights: Float64Array;
  /** By splat that is drawn. */
  readonly #depthBits: Uint32Array;
  readonly #drawn: Float64Array[];
  readonly #levels: Uint8Array;
  readonly #order: Uint32Array;
  readonly #depthBins = new Uint32Array(MOST_BINS + 1);
  readonly #slices: number;
  /** By level, of one slice, for each cell: optical depth, its sharp part, and its blurred part behind. */
  readonly #slice: Float64Array[];
  /** Cells of the frame. */
  readonly #frame: {
    readonly left: number;
    readonly top: number;
    readonly right: number;
    readonly bottom: number;
  };
  readonly #transmittance: Float64Array;
  readonly #sharp: Float64Array;
  readonly #background: Float64Array;

  /** @param most largest number of splats to draw, taken evenly from the detail's. */
  constructor(detail: SceneDetail, most: number, shape: TrialShape) {
    const step = Math.max(1, Math.floor(detail.count / most));
    const count = Math.ceil(detail.count / step);
    const of = (value: (i: number) => number) =>
      Float64Array.from({ length: count }, (_, i) => value(i * step));
    const { x, y, z, sigmas, opacities, nearDetails, interests } = detail;
    this.#count = count;
    this.#weight = (detail.weight * detail.count) / count;
    this.#columns = [
      of((i) => x[i]),
      of((i) => y[i]),
      of((i) => z[i]),
      of((i) => sigmas[3 * i + 2]),
      of((i) => AREA * sigmas[3 * i + 1] * sigmas[3 * i + 2]),
      of((i) => opacities[i]),
      of((i) => nearDetails[i]),
      of((i) => interests[i]),
    ];
    [this.#totalDetail, this.#totalInterest] = this.#columns
      .slice(6)
      .map((values) => values.reduce((sum, value) => sum + value, 0));
    this.#shape = shape;
    const isWide = shape.tangentX >= shape.tangentY;
    const [columns, rows] = isWide ? [LONG_CELLS, SHORT_CELLS] : [SHORT_CELLS, LONG_CELLS];
    this.#grid = { columns, rows };
    this.#middleWeights = middleWeights(columns, rows);
    this.#depthBits = new Uint32Array(count);
    this.#drawn = Array.from({ length: 8 }, () => new Float64Array(count));
    this.#levels = new Uint8Array(count);
    this.#order = new Uint32Array(count);
    this.#slices = Math.min(MOST_SLICES, Math.ceil(count / SLICE_SPLATS));
    this.#slice = Array.from(
      { length: LEVELS },
      (_, level) => new Float64Array(3 * (columns >> level) * (rows >> level)),
    );
    const [left, top] = [columns, rows].map((cells) => Math.floor((cells - cells / PADDED) / 2));
    this.#frame = { left, top, right: columns - left, bottom: rows - top };
    this.#transmittance = new Float64Array(columns * rows);
    this.#sharp = new Float64Array(columns * rows);
    this.#background = new Float64Array(columns * rows);
  }

  picture({ position, target }: TrialCamera, up: Vec3): TrialPicture {
    const offset: Vec3 = [target[0] - position[0], target[1] - position[1], target[2] - position[2]];
    const distance = Math.sqrt(dot(offset, offset));
    const forward = unit(offset);
    const right = unit(cross(forward, up));
    const above = cross(right, forward);
    const { framed, kept } = this.#project(position, distance, { forward, right, above });
    this.#sort(kept);
    return { framed: framed / this.#totalDetail, ...this.#blend(kept) };
  }

  /** Finds where splats are in the picture, and how sharp. @returns the number that are drawn. */
  #project(
    [px, py, pz]: Vec3,
    distance: number,
    { forward, right, above }: { readonly forward: Vec3; readonly right: Vec3; readonly above: Vec3 },
  ): { readonly framed: number; readonly kept: number } {
    const { tangentX, tangentY } = this.#shape;
    const { columns, rows } = this.#grid;
    const [xs, ys, zs, sigmas, areas, opacities, details, interests] = this.#columns;
    const [cellX, cellY, depths, sharps, backgrounds, seen, interesting, away] = this.#drawn;
    const focalPx = SHORTER_SIDE_PX / 2 / Math.min(tangentX, tangentY);
    const [forwardX, forwardY, forwardZ] = forward;
    const [rightX, rightY, rightZ] = right;
    const [aboveX, aboveY, aboveZ] = above;
    const nearest = NEAR_PART * distance;
    let framed = 0;
    let kept = 0;
    for (let i = 0; i < this.#count; i++) {
      const dx = xs[i] - px;
      const dy = ys[i] - py;
      const dz = zs[i] - pz;
      const depth = dx * forwardX + dy * forwardY + dz * forwardZ;
      if (!(depth > nearest)) continue;
      const x = (dx * rightX + dy * rightY + dz * rightZ) / (depth * tangentX);
      if (!(x > -PADDED && x < PADDED)) continue;
      const y = (dx * aboveX + dy * aboveY + dz * aboveZ) / (depth * tangentY);
      if (!(y > -PADDED && y < PADDED)) continue;
      if (x > -FRAMED && x < FRAMED && y > -FRAMED && y < FRAMED) framed += details[i];
      const scale = focalPx / depth;
      const sigmaPx = sigmas[i] * scale;
      let level = 0;
      for (let cell = CELL_PX / 4; sigmaPx > cell && level < LEVELS - 1; cell *= 2) level++;
      const isInFrame = x > -1 && x < 1 && y > -1 && y < 1;
      if (level === 0 && !isInFrame) continue;
      const levelPx = CELL_PX * (1 << level);
      const opticalDepth =
        this.#weight * opacities[i] * Math.min(1, (areas[i] * scale * scale) / (levelPx * levelPx));
      const sharp = Math.min(1, Math.max(0, 1 - octaves(sigmaPx / SHARP_PX) / BLURRED_OCTAVES));
      cellX[kept] = Math.min(columns - 1, Math.floor(((x + PADDED) / (2 * PADDED)) * columns));
      cellY[kept] = Math.min(rows - 1, Math.floor(((PADDED - y) / (2 * PADDED)) * rows));
      depths[kept] = opticalDepth;
      sharps[kept] = opticalDepth * sharp;
      backgrounds[kept] = depth > distance ? opticalDepth * (1 - sharp) : 0;
      seen[kept] = isInFrame ? details[i] : 0;
      interesting[kept] = interests[i];
      away[kept] = depth;
      this.#levels[kept] = level;
      this.#depthBits[kept] = depthBin(depth / nearest);
      kept++;
    }
    return { framed, kept };
  }

  /** Orders the drawn splats by depth. */
  #sort(kept: number): void {
    const bins = this.#depthBins;
    bins.fill(0);
    for (let i = 0; i < kept; i++) bins[this.#depthBits[i] + 1]++;
    for (let bin = 0; bin < MOST_BINS; bin++) bins[bin + 1] += bins[bin];
    for (let i = 0; i < kept; i++) this.#order[bins[this.#depthBits[i]]++] = i;
  }

  #blend(kept: number): Omit<TrialPicture, 'framed'> {
    const { columns } = this.#grid;
    const [cellX, cellY, depths, sharps, backgrounds, seen, interesting, away] = this.#drawn;
    const transmittance = this.#transmittance.fill(1);
    this.#sharp.fill(0);
    this.#background.fill(0);
    let visible = 0;
    let visibleInterest = 0;
    let visibleDepth = 0;
    let end = 0;
    for (let slice = 1; slice <= this.#slices; slice++) {
      const start = end;
      end = Math.floor((slice * kept) / this.#slices);
      let largest = 0;
      for (let k = start; k < end; k++) {
        const i = this.#order[k];
        const level = this.#levels[i];
        if (level > largest) largest = level;
        const cells = this.#slice[level];
        const at = 3 * ((cellY[i] >> level) * (columns >> level) + (cellX[i] >> level));
        cells[at] += depths[i];
        cells[at + 1] += sharps[i];
        cells[at + 2] += backgrounds[i];
        if (seen[i] === 0) continue;
        const through = transmittance[cellY[i] * columns + cellX[i]];
        visible += seen[i] * through;
        visibleInterest += interesting[i] * through;
        visibleDepth += seen[i] * through * away[i];
      }
      this.#spread(largest);
      this.#composite(largest > 0);
    }
    const depth = visible > 0 ? visibleDepth / visible : 0;
    return {
      visible: visible / this.#totalDetail,
      interesting: visibleInterest / this.#totalInterest,
      depth,
      ...this.#shares(),
    };
  }

  /** Spreads the sums of coarse cells, where large splats were drawn, over cells of the first level. */
  #spread(largest: number): void {
    const { columns, rows } = this.#grid;
    for (let level = largest; level > 1; level--) {
      const coarse = this.#slice[level];
      const fine = this.#slice[level - 1];
      const width = columns >> level;
      const height = rows >> level;
      for (let y = 0; y < height; y++) {
        for (let x = 0; x < width; x++) {
          const from = 3 * (y * width + x);
          if (coarse[from] === 0) continue;
          for (let part = 0; part < 3; part++) {
            const value = coarse[from + part];
            const to = 3 * (4 * y * width + 2 * x) + part;
            fine[to] += value;
            fine[to + 3] += value;
            fine[to + 6 * width] += value;
            fine[to + 6 * width + 3] += value;
            coarse[from + part] = 0;
          }
        }
      }
    }
  }

  /** Blends a slice behind the nearer ones, and clears it. */
  #composite(hasLarge: boolean): void {
    const { columns } = this.#grid;
    const { left, top, right, bottom } = this.#frame;
    const [fine, coarse] = this.#slice;
    const transmittance = this.#transmittance;
    for (let y = top; y < bottom; y++) {
      for (let x = left; x < right; x++) {
        const at = y * columns + x;
        let from = 3 * at;
        let depth = fine[from];
        let sharp = fine[from + 1];
        let background = fine[from + 2];
        if (depth > 0) fine[from] = fine[from + 1] = fine[from + 2] = 0;
        if (hasLarge) {
          from = 3 * ((y >> 1) * (columns >> 1) + (x >> 1));
          depth += coarse[from];
          sharp += coarse[from + 1];
          background += coarse[from + 2];
        }
        if (depth === 0 || transmittance[at] < LEAST_TRANSMITTANCE) continue;
        const through = exp(-depth);
        const part = (transmittance[at] * (1 - through)) / depth;
        this.#sharp[at] += part * sharp;
        this.#background[at] += part * background;
        transmittance[at] *= through;
      }
    }
    if (hasLarge) coarse.fill(0);
  }

  #shares() {
    const { columns } = this.#grid;
    const { left, top, right, bottom } = this.#frame;
    const sums = { sharp: 0, sharpInMiddle: 0, background: 0, empty: 0 };
    let middle = 0;
    for (let y = top; y < bottom; y++) {
      for (let x = left; x < right; x++) {
        const at = y * columns + x;
        const weight = this.#middleWeights[at];
        sums.sharp += this.#sharp[at];
        sums.sharpInMiddle += this.#sharp[at] * weight;
        sums.background += this.#background[at];
        sums.empty += this.#transmittance[at];
        middle += weight;
      }
    }
    const cells = (right - left) * (bottom - top);
    const [sharpPart, backgroundPart, empty] = [sums.sharp, sums.background, sums.empty].map(
      (sum) => sum / cells,
    );
    return {
      sharp: sharpPart,
      sharpInMiddle: sums.sharpInMiddle / middle,
      background: backgroundPart,
      empty,
      fog: Math.max(0, 1 - sharpPart - backgroundPart - empty),
    };
  }
}

/** By cell of the padded picture, 1 in its middle. */
function middleWeights(columns: number, rows: number): Float64Array {
  return Float64Array.from({ length: columns * rows }, (_, at) => {
    const x = (((at % columns) + 0.5) / columns - 0.5) * 2 * PADDED;
    const y = ((Math.floor(at / columns) + 0.5) / rows - 0.5) * 2 * PADDED;
    return exp(-1.5 * (x * x + y * y));
  });
}

const float = new Float32Array(1);
const bits = new Uint32Array(float.buffer);

/** The base-2 logarithm of a number above 0, to 0.01. */
function octaves(value: number): number {
  float[0] = value;
  const mantissa = (bits[0] & 0x7fffff) / 0x800000;
  return (bits[0] >>> 23) - 127 + mantissa * (1.3465 - 0.3465 * mantissa);
}

/** Ascends with depth, which is at least 1. */
function depthBin(depth: number): number {
  float[0] = depth;
  return Math.min(MOST_BINS - 1, (bits[0] >>> DEPTH_SHIFT) - (0x3f800000 >>> DEPTH_SHIFT));
}
