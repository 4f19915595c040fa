import type { Vec3 } from '../math/mat4.ts';
import { selectValue } from '../math/select-value.ts';

/** Nearest origin: differences of float32 beyond are 0 or normal, which no device flushes to 0. */
const NEAREST = 2 ** -100;
/** An origin is worth it beyond so many times the distance within which the bulk lies: 4 bits of 24. */
const BULK_REACHES = 16;
/** Part of the sample that is the bulk. */
const BULK = { wide: 1 / 2, float32: 9 / 10 } as const;

/**
 * The point that positions are stored relative to: on each axis 0, or the median of the coordinates
 * if they lie so far out that float32 would lose precision there. They do if
 *
 * - |median| > 4 · half the largest side of the bounds; or
 * - |median| > 16 · the distance from the median within which the bulk lies. Strays do not count
 *   here: failed points at 0, or outliers.
 *
 * Most files thus keep their coordinates as they are. `p − origin` is exact for float32 coordinates
 * from half to twice the origin (Sterbenz): for all in the first case, and for nine tenths or more in
 * the second. Only strays are rounded, to a step of the larger of the two. Positions of more
 * precision are rounded in any case, so more than half of them decide.
 *
 * @param axes sampled x, y and z in the scene's space, of equally many positions: see `OriginSample`.
 * @param bounds of all positions.
 * @param isWide whether positions have more precision than float32.
 */
export function chooseOrigin(
  axes: readonly ArrayLike<number>[],
  { min, max }: { readonly min: ArrayLike<number>; readonly max: ArrayLike<number> },
  isWide: boolean,
): Vec3 {
  const [{ length }] = axes;
  if (length === 0) return [0, 0, 0];
  const medians = axes.map(medianOf);
  const share = isWide ? BULK.wide : BULK.float32;
  const last = Math.max(length >>> 1, Math.ceil(share * length) - 1);
  const spreads = axes.map((values, axis) => {
    const distances = Float64Array.from(values, (value) => Math.abs(value - medians[axis]));
    return selectValue(distances, last);
  });
  const halfExtent = Math.max(max[0] - min[0], max[1] - min[1], max[2] - min[2]) / 2;
  const nearest = Math.max(NEAREST, Math.min(4 * halfExtent, BULK_REACHES * Math.max(...spreads)));
  const originOf = (axis: number) => {
    const origin = Math.fround(medians[axis]);
    // Strays at the other end of float32's range would be infinite.
    const isHeld = [min, max].every((corner) => Number.isFinite(Math.fround(corner[axis] - origin)));
    return Math.abs(origin) > nearest && isHeld ? origin : 0;
  };
  return [originOf(0), originOf(1), originOf(2)];
}

/** Of an even number of values, the middle between two. */
function medianOf(values: ArrayLike<number>): number {
  const copy = Float64Array.from(values);
  return (selectValue(copy, (copy.length - 1) >>> 1) + selectValue(copy, copy.length >>> 1)) / 2;
}

/** The origin for splats of which these positions, float64 in the scene's space, are a sample; 3N. */
export function originOfSamples(positions: Float64Array): Vec3 {
  const count = positions.length / 3;
  const sample = new OriginSample(count);
  sample.addAll(positions, count);
  return chooseOrigin(sample.axes, boundsOf(sample.axes), true);
}

function boundsOf(axes: readonly Float64Array[]): { readonly min: number[]; readonly max: number[] } {
  const reduce = (pick: (a: number, b: number) => number) =>
    axes.map((values) => values.reduce(pick, values[0]));
  return { min: reduce((a, b) => Math.min(a, b)), max: reduce((a, b) => Math.max(a, b)) };
}

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

/** The rows that `OriginSample` keeps of so many. */
export function sampledRows(rows: number): Uint32Array<ArrayBuffer> {
  const halvings = halvingsOf(rows);
  const sampled: number[] = [];
  for (let row = 0; row < rows; row++) if (isSampled(row, halvings)) sampled.push(row);
  return Uint32Array.from(sampled);
}

/**
 * About 4,096 positions of any number of rows, from which `chooseOrigin` takes its medians. Which
 * they are depends on the number of rows alone, not on how many come at once.
 */
export class OriginSample {
  /** Row, x, y and z of each. */
  #values: number[] = [];
  #halvings: number;

  /** @param rows if known; more may come. */
  constructor(rows = 0) {
    this.#halvings = halvingsOf(rows);
  }

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
