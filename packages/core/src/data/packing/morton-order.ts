import type { Vec3 } from '../math/mat4.ts';
import { mapColumns } from '../splats/columns.ts';
import { coefficientsPerSplat, type SplatSet } from '../splats/splat-set.ts';
import type { Turns } from '../turns.ts';
import { emptyBounds, widenBounds } from './center-bounds.ts';
import { type Harmonics, isPacked, isPalette } from './harmonics.ts';
import { bulkOf, PositionSample } from './position-sample.ts';

/** Bits per axis of a Morton code: 48 in all. */
const BITS_PER_AXIS = 16;
/** Largest cell along an axis. */
const LAST_CELL = (1 << BITS_PER_AXIS) - 1;
/** Columns that hold a code, and the bits of each. */
const COLUMNS = 3;
const COLUMN_BITS = 16;
/** Rows of a step, which takes a millisecond or so. */
const STEP_ROWS = 1 << 14;
/**
 * From here on, three passes with digits of 16 bits take less time than six with digits of 8.
 * Below, tables of 65,536 counts take most of it: a millisecond for a cloud of any size.
 */
const MANY_SPLATS = 32_768;

/** Smallest normal float32: WGSL lets a device take any smaller number for 0. */
const SMALLEST_NORMAL = 2 ** -126;
/** Largest power of two in float32. */
const LARGEST_POWER = 2 ** 127;

/**
 * The grid of cells, 2¹⁶ along the longest axis, from which Morton codes are made. All numbers are
 * float32, and so is every step from a coordinate to its cell, each rounded to nearest: the GPU
 * finds the same cells as the host to the bit.
 *
 *     cell = min(65535, floor((p · scale − scaledMin) · cellsPerUnit)), where p is 0 if it is subnormal,
 *     and the nearest coordinate within the frame if it is outside
 */
export interface MortonFrame {
  /** Least and largest coordinates, by axis. */
  readonly min: Vec3;
  readonly max: Vec3;
  /**
   * By axis. A power of two that brings the longest extent to 1…2, or as near to that as float32
   * allows, so that all other numbers are within range for any cloud; 0 where all centres have one
   * coordinate, which may be too large for that. The product with it is exact wherever it decides
   * on the cell.
   */
  readonly scale: Vec3;
  /** `min` times `scale`. */
  readonly scaledMin: Vec3;
  /** Cells per scaled unit; 0 where all centres are in one cell. */
  readonly cellsPerUnit: number;
}

/** Part of a cloud that the cells of its frame have to tell apart. */
const BULK = 9 / 10;
/** A frame reaches so many times as far as the bulk at most: that keeps 2¹⁰ cells for the bulk. */
const BULK_REACHES = 64;

/**
 * The frame of a cloud: of all its centres, or of the region around most of them if single ones lie
 * so far out that all others would be in a few cells.
 *
 * @param axes float32 x, y and z of a `PositionSample` of the centres.
 * @param bounds of all centres.
 */
export function cloudFrame(
  axes: readonly ArrayLike<number>[],
  { min, max }: { readonly min: ArrayLike<number>; readonly max: ArrayLike<number> },
): MortonFrame {
  if (axes[0].length === 0) return mortonFrame(min, max);
  const { medians, spread } = bulkOf(axes, BULK);
  const reach = BULK_REACHES * spread;
  if (!(reach > 0)) return mortonFrame(min, max);
  return mortonFrame(
    vec3((axis) => Math.max(min[axis], Math.fround(medians[axis] - reach))),
    vec3((axis) => Math.min(max[axis], Math.fround(medians[axis] + reach))),
  );
}

/**
 * The frame of centres whose least and largest float32 coordinates are `min` and `max`. Any other
 * centre counts as the nearest point within.
 */
export function mortonFrame(min: ArrayLike<number>, max: ArrayLike<number>): MortonFrame {
  const low = vec3((axis) => withoutSubnormals(min[axis]));
  const high = vec3((axis) => withoutSubnormals(max[axis]));
  const extents = vec3((axis) => high[axis] - low[axis]);
  // One step for all axes: cells are cubes, so a flat scene wastes no order on its thin side.
  const extent = Math.max(...extents);
  // The least coordinate of no splats is above the largest.
  if (!(extent > 0))
    return { min: [0, 0, 0], max: [0, 0, 0], scale: [0, 0, 0], scaledMin: [0, 0, 0], cellsPerUnit: 0 };
  const nearest = 2 ** -Math.floor(Math.log2(extent));
  const power = Math.max(SMALLEST_NORMAL, Math.min(LARGEST_POWER, nearest));
  const scale = vec3((axis) => (extents[axis] > 0 ? power : 0));
  const scaledMin = vec3((axis) => Math.fround(low[axis] * scale[axis]));
  return { min: low, max: high, scale, scaledMin, cellsPerUnit: Math.fround(LAST_CELL / (extent * power)) };
}

/** The cell of a float32 coordinate of a centre along `axis`, 0…65535. */
export function mortonCell(coordinate: number, axis: number, frame: MortonFrame): number {
  const within = Math.max(frame.min[axis], Math.min(frame.max[axis], withoutSubnormals(coordinate)));
  const scaled = Math.fround(within * frame.scale[axis]);
  const cells = Math.fround(Math.fround(scaled - frame.scaledMin[axis]) * frame.cellsPerUnit);
  return Math.min(LAST_CELL, cells) | 0;
}

function withoutSubnormals(value: number): number {
  return Math.abs(value) < SMALLEST_NORMAL ? 0 : value;
}

/**
 * Storage order of splats: by the Morton code of their centres within the bounds; equal codes keep
 * the given order. Neighbours in space become neighbours in memory, so that a run of splats has
 * small bounds.
 *
 * @param positions 3N finite coordinates.
 * @param frame default: the bounds of these centres. For a part of a cloud, pass the cloud's frame.
 * @returns N indices into the given order.
 */
export function mortonOrder(positions: Float32Array, count: number, frame?: MortonFrame): Uint32Array {
  const steps = mortonSteps(positions, count, frame);
  for (;;) {
    const { done, value } = steps.next();
    if (done) return value;
  }
}

/**
 * As `mortonOrder`, with turns for the event loop. Rejects with the reason of the turns' signal.
 *
 * @param onProgress told how much of the work is done, from 0 to 1.
 */
export async function mortonOrderInTurns(
  positions: Float32Array,
  count: number,
  turns: Turns,
  onProgress?: (fraction: number) => void,
): Promise<Uint32Array> {
  const steps = mortonSteps(positions, count);
  for (;;) {
    const { done, value } = steps.next();
    if (done) return value;
    onProgress?.(value);
    await turns.give();
  }
}

/** As `mortonOrder`, in short steps; yields how much is done after each, from 0 to 1. */
export function* mortonSteps(
  positions: Float32Array,
  count: number,
  given?: MortonFrame,
): Generator<number, Uint32Array, void> {
  const digitBits = count < MANY_SPLATS ? COLUMN_BITS / 2 : COLUMN_BITS;
  // For bounds, for codes, and twice to sort by each digit.
  const passes = 2 + 2 * ((COLUMNS * COLUMN_BITS) / digitBits);
  let pass = 0;
  function* overRows(work: (from: number, to: number) => void): Generator<number, void, void> {
    for (let from = 0; from < count; from += STEP_ROWS) {
      const to = Math.min(count, from + STEP_ROWS);
      work(from, to);
      yield (pass + to / count) / passes;
    }
    pass++;
  }
  const bounds = emptyBounds();
  yield* overRows((from, to) => widenBounds(bounds, positions, from, to));
  const sample = new PositionSample();
  if (!given) sample.addAll(positions, count);
  const frame = given ?? cloudFrame(sample.axes, bounds);
  const codes = Array.from({ length: COLUMNS }, () => new Uint16Array(count));
  let order: Uint32Array = new Uint32Array(count);
  yield* overRows((from, to) => {
    encodeRows(positions, frame, codes, from, to);
    for (let i = from; i < to; i++) order[i] = i;
  });
  let next: Uint32Array = new Uint32Array(count);
  // Least significant digit first; each pass is stable, so equal codes keep the given order.
  for (const column of codes) {
    for (let shift = 0; shift < COLUMN_BITS; shift += digitBits) {
      const digit = { column, shift, last: (1 << digitBits) - 1 };
      const offsets = new Uint32Array(digit.last + 2);
      yield* overRows((from, to) => countDigits(digit, offsets, from, to));
      for (let value = 0; value < digit.last; value++) offsets[value + 1] += offsets[value];
      yield* overRows((from, to) => scatterRows(digit, order, next, offsets, from, to));
      [order, next] = [next, order];
    }
  }
  return order;
}

/** Some bits of each value of a column of codes. */
interface Digit {
  readonly column: Uint16Array;
  readonly shift: number;
  /** Largest value of the digit. */
  readonly last: number;
}

function countDigits({ column, shift, last }: Digit, counts: Uint32Array, from: number, to: number): void {
  for (let i = from; i < to; i++) counts[((column[i] >> shift) & last) + 1]++;
}

function scatterRows(
  { column, shift, last }: Digit,
  order: Uint32Array,
  next: Uint32Array,
  offsets: Uint32Array,
  from: number,
  to: number,
): void {
  for (let i = from; i < to; i++) next[offsets[(column[order[i]] >> shift) & last]++] = order[i];
}

/** Bits per axis of a digit of `mortonDigits`. */
const DIGIT_AXIS_BITS = 6;
/** Values that a digit of `mortonDigits` can have. */
export const MORTON_DIGITS = 1 << (3 * DIGIT_AXIS_BITS);
/** Shifts of digits of `mortonDigits` that tell all codes apart, the most significant first. */
export const MORTON_SHIFTS = [10, 5, 0] as const;

/**
 * Some bits of the Morton codes of rows: bits `shift` to `shift + 5` of each axis. Codes that agree
 * in all bits above are in the order of these digits.
 *
 * @param rows whose first three values are the coordinates of a centre.
 * @param width values of a row.
 */
export function mortonDigits(
  rows: Float32Array,
  width: number,
  frame: MortonFrame,
  shift: number,
): Uint32Array {
  const last = (1 << DIGIT_AXIS_BITS) - 1;
  const digits = new Uint32Array(rows.length / width);
  for (let i = 0; i < digits.length; i++) {
    let digit = 0;
    for (let axis = 0; axis < 3; axis++)
      digit |= spread((mortonCell(rows[i * width + axis], axis, frame) >> shift) & last) << axis;
    digits[i] = digit;
  }
  return digits;
}

/** The splats of `set` that `order` lists, in that order. */
export function permuteSplats<Kind extends Harmonics>(
  set: SplatSet<Kind>,
  order: Uint32Array,
): SplatSet<Kind> {
  return {
    ...set,
    ...mapColumns(set, (column, width) => permuted(column, order, width)),
    count: order.length,
    harmonics: permutedHarmonics(set.harmonics, order),
  };
}

/** Writes the 48-bit codes of some rows into columns of 16 bits, least significant first. */
function encodeRows(
  positions: Float32Array,
  frame: MortonFrame,
  [low, middle, high]: readonly Uint16Array[],
  from: number,
  to: number,
): void {
  for (let i = from; i < to; i++) {
    const x = mortonCell(positions[3 * i], 0, frame);
    const y = mortonCell(positions[3 * i + 1], 1, frame);
    const z = mortonCell(positions[3 * i + 2], 2, frame);
    // 16 bits of code take 5⅓ bits of each axis, interleaved through a table of spread bytes.
    const lowBits = spread(x & 0xff) | (spread(y & 0xff) << 1) | (spread(z & 0xff) << 2);
    const highBits = spread(x >> 8) | (spread(y >> 8) << 1) | (spread(z >> 8) << 2);
    low[i] = lowBits & 0xffff;
    middle[i] = (lowBits >>> 16) | ((highBits & 0xff) << 8);
    high[i] = highBits >>> 8;
  }
}

function vec3(component: (axis: number) => number): Vec3 {
  return [component(0), component(1), component(2)];
}

/** The eight bits of `byte` with two zeros between each. */
function spread(byte: number): number {
  let bits = (byte | (byte << 8)) & 0x00f00f;
  bits = (bits | (bits << 4)) & 0x0c30c3;
  return (bits | (bits << 2)) & 0x249249;
}

function permutedHarmonics<Kind extends Harmonics>(harmonics: Kind, order: Uint32Array): Kind {
  if (isPacked(harmonics)) {
    return { ...harmonics, words: permuted(harmonics.words, order, harmonics.wordsPerSplat) };
  }
  if (isPalette(harmonics)) return { ...harmonics, indices: permuted(harmonics.indices, order, 1) };
  const width = coefficientsPerSplat(harmonics.degree);
  return { ...harmonics, coefficients: permuted(harmonics.coefficients, order, width) };
}

function permuted<Column extends Float32Array | Float64Array | Uint32Array | Uint16Array>(
  column: Column,
  order: Uint32Array,
  width: number,
): Column {
  const result = new (column.constructor as new (length: number) => Column)(order.length * width);
  for (let i = 0; i < order.length; i++) {
    const from = order[i] * width;
    for (let k = 0; k < width; k++) result[i * width + k] = column[from + k];
  }
  return result;
}
