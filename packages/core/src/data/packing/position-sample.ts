import type { Vec3 } from '../math/mat4.ts';
import { selectValue } from '../math/select-value.ts';

/** Rows that are all sampled; of more, one of two, of four and so on. */
const ALL_SAMPLED = 1 << 12;

/** How often rows are halved for a sample of so many. */
function halvingsOf(rows: number): number {
  return Math.max(0, Math.ceil(Math.log2(rows / ALL_SAMPLED)));
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

/**
 * About 4,096 positions of any number of rows, which tell where most of them lie. Which ones they are
 * depends on the number of rows alone, not on how many come at once.
 */
export class PositionSample {
  /** Row, x, y and z of each. */
  #values: number[] = [];
  #halvings = 0;

  /** Adds a position, unless it is not finite. Rows come in ascending order. */
  add(row: number, x: number, y: number, z: number): void {
    const halvings = halvingsOf(row + 1);
    if (halvings > this.#halvings) this.#halve(halvings);
    if (!isSampled(row, this.#halvings)) return;
    if (Number.isFinite(x) && Number.isFinite(y) && Number.isFinite(z)) this.#values.push(row, x, y, z);
  }

  /** Adds the first `count` positions about an origin, as rows from `first` on. */
  addAll(positions: ArrayLike<number>, count: number, origin: Vec3 = [0, 0, 0], first = 0): void {
    const [x, y, z] = origin;
    for (let i = 0; i < count; i++)
      this.add(first + i, positions[3 * i] + x, positions[3 * i + 1] + y, positions[3 * i + 2] + z);
  }

  /** Row, x, y and z of each sampled position from a row on, for `addValues`. */
  valuesFrom(row: number): Float64Array<ArrayBuffer> {
    return Float64Array.from(this.#values.filter((_, i) => this.#values[i - (i % 4)] >= row));
  }

  /** Adds positions that another sample has kept, of rows after all that are here. */
  addValues(values: Float64Array): void {
    for (let at = 0; at < values.length; at += 4)
      this.add(values[at], values[at + 1], values[at + 2], values[at + 3]);
  }

  /** Sampled x, y and z. */
  get axes(): Float64Array<ArrayBuffer>[] {
    const count = this.#values.length / 4;
    return [1, 2, 3].map((at) => Float64Array.from({ length: count }, (_, i) => this.#values[4 * i + at]));
  }

  #halve(halvings: number): void {
    this.#halvings = halvings;
    const values = this.#values;
    this.#values = [];
    for (let at = 0; at < values.length; at += 4)
      if (isSampled(values[at], halvings)) this.#values.push(...values.slice(at, at + 4));
  }
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
