import type { Vec3 } from '../math/mat4.ts';
import { selectValue } from '../math/select-value.ts';

/** Rows that are all sampled; of more, one of two, of four and so on. */
const ALL_SAMPLED = 1 << 12;

/** How often rows are halved for a sample of so many. */
function halvingsOf(rows: number): number {
  return rows <= ALL_SAMPLED ? 0 : Math.ceil(Math.log2(rows / ALL_SAMPLED));
}

/** Whether a row is in the sample. Sampled rows are spread evenly, by multiples of the golden ratio. */
function isSampled(row: number, halvings: number): boolean {
  return halvings === 0 || Math.imul(row, 0x9e3779b1) >>> (32 - halvings) === 0;
}

/** The rows that a `PositionSample` keeps of so many. */
export function sampledRows(rows: number): Uint32Array<ArrayBuffer> {
  const halvings = halvingsOf(rows);
  const sampled: number[] = [];
  for (let row = 0; row < rows; row++) if (isSampled(row, halvings)) sampled.push(row);
  return Uint32Array.from(sampled);
}

/** Values of a sampled row: its number, x, y, z, and the splat's size. */
const ROW_VALUES = 5;

/**
 * About 4,096 positions of any number of rows, which tell where most of them lie, and sizes of the
 * splats there. Which ones they are depends on the number of rows alone, not on how many come at
 * once.
 */
export class PositionSample {
  /** ROW_VALUES of each. */
  #values: number[] = [];
  #halvings = 0;

  /** Adds a position, unless it is not finite. Rows come in ascending order. */
  add(row: number, x: number, y: number, z: number, size = 0): void {
    if (!this.#takes(row)) return;
    if (Number.isFinite(x) && Number.isFinite(y) && Number.isFinite(z)) this.#values.push(row, x, y, z, size);
  }

  /**
   * Adds the first `count` positions about an origin, as rows from `first` on.
   *
   * @param logScales of the splats, whose sizes are 0 without.
   */
  addAll(
    positions: ArrayLike<number>,
    count: number,
    origin: Vec3 = [0, 0, 0],
    first = 0,
    logScales?: ArrayLike<number>,
  ): void {
    const [x, y, z] = origin;
    for (let i = 0; i < count; i++) {
      if (!this.#takes(first + i)) continue;
      const at = 3 * i;
      const size = logScales ? splatSize(logScales, at) : 0;
      this.add(first + i, positions[at] + x, positions[at + 1] + y, positions[at + 2] + z, size);
    }
  }

  /** Values of rows from this one on, for `addValues`. */
  valuesFrom(row: number): Float64Array<ArrayBuffer> {
    return Float64Array.from(this.#values.filter((_, i) => this.#values[i - (i % ROW_VALUES)] >= row));
  }

  /** Adds values that another sample has kept, of rows after all that are here. */
  addValues(values: Float64Array): void {
    for (let at = 0; at < values.length; at += ROW_VALUES) {
      const [row, x, y, z, size] = values.subarray(at, at + ROW_VALUES);
      this.add(row, x, y, z, size);
    }
  }

  /** Sampled x, y and z. */
  get axes(): Float64Array<ArrayBuffer>[] {
    return [this.#column(1), this.#column(2), this.#column(3)];
  }

  /** Median of the sampled splats' sizes, scene units; 0 without splats. */
  get medianSize(): number {
    return this.#values.length > 0 ? medianOf(this.#column(4)) : 0;
  }

  /** Whether a row is sampled. Rows before may be no more, then. */
  #takes(row: number): boolean {
    if (row >= ALL_SAMPLED * 2 ** this.#halvings) this.#halve(halvingsOf(row + 1));
    return isSampled(row, this.#halvings);
  }

  #column(at: number): Float64Array<ArrayBuffer> {
    const count = this.#values.length / ROW_VALUES;
    return Float64Array.from({ length: count }, (_, i) => this.#values[ROW_VALUES * i + at]);
  }

  #halve(halvings: number): void {
    this.#halvings = halvings;
    this.#values = this.#values.filter((_, i) => isSampled(this.#values[i - (i % ROW_VALUES)], halvings));
  }
}

/**
 * The size that a splat's place is seen beside: the standard deviation, in scene units, along the
 * middle one of its axes. It is the width of both a needle and a disc.
 *
 * @param at where its three log scales begin.
 */
export function splatSize(logScales: ArrayLike<number>, at: number): number {
  const [a, b, c] = [logScales[at], logScales[at + 1], logScales[at + 2]];
  return Math.exp(Math.max(Math.min(a, b), Math.min(Math.max(a, b), c)));
}

/** Where most of a sample of positions lies. */
export interface Bulk {
  readonly medians: Vec3;
  /** Distance from the median along any axis within which the bulk lies. */
  readonly spread: number;
}

/**
 * The bulk of a sample.
 *
 * @param axes x, y and z of the sample, at least one of each.
 * @param share of the sample that is the bulk, at least half.
 */
export function bulkOf(axes: readonly ArrayLike<number>[], share: number): Bulk {
  const [x, y, z] = axes.map(medianOf);
  const spreads = axes.map((values, axis) => {
    const distances = Float64Array.from(values, (value) => Math.abs(value - [x, y, z][axis]));
    return selectValue(distances, Math.max(values.length >>> 1, Math.ceil(share * values.length) - 1));
  });
  return { medians: [x, y, z], spread: Math.max(...spreads) };
}

/** Of an even number of values, the middle between two. */
function medianOf(values: ArrayLike<number>): number {
  const copy = Float64Array.from(values);
  return (selectValue(copy, (copy.length - 1) >>> 1) + selectValue(copy, copy.length >>> 1)) / 2;
}
