import { ROWS_AT_ONCE, splitRows } from '../../../data/packing/split-rows.ts';
import type { Turns } from '../../../data/turns.ts';

/** Values of a codebook. */
const SIZE = 256;
/** Further iterations hardly move the values. */
const ROUNDS = 10;
/** Bins of equal counts, whose widths estimate the density of values. */
const INTERVALS = 4096;

/** A codebook of 256 values; a number is encoded by the nearest one. */
export class Codebook {
  /** Ascending float32 values; the last ones are equal if fewer suffice. */
  readonly values: Float64Array;
  /** Midpoint between `values[i]` and `values[i + 1]`. */
  readonly #middles: Float64Array;

  constructor(values: Float64Array) {
    this.values = values.map(Math.fround);
    this.#middles = Float64Array.from(
      { length: SIZE - 1 },
      (_, i) => (this.values[i] + this.values[i + 1]) / 2,
    );
  }

  /** Index of the nearest value. */
  nearest(value: number): number {
    let low = 0;
    let high = SIZE - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (value > this.#middles[middle]) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  rounded(value: number): number {
    return this.values[this.nearest(value)];
  }
}

/**
 * Computes the codebook of values by k-means in one dimension; the error is the sum of squared
 * differences. If there are at most 256 distinct values, the codebook has exactly these.
 *
 * @param values one or more finite values; sorted in place.
 */
export async function findCodebook(values: Float32Array, turns: Turns): Promise<Codebook> {
  const { leafCount, starts } = await splitRows(values, new Uint32Array(values.length), 1, SIZE, turns);
  for (let leaf = 0; leaf < leafCount; leaf++) {
    values.subarray(starts[leaf], starts[leaf + 1]).sort();
    await turns.give();
  }
  const different = await fewDifferent(values, turns);
  if (different) {
    const padded = new Float64Array(SIZE).fill(different[different.length - 1]);
    padded.set(different);
    return new Codebook(padded);
  }
  const leafMeans = new Float64Array(SIZE);
  for (let leaf = 0; leaf < leafCount; leaf++)
    leafMeans[leaf] = await meanOf(values, starts[leaf], starts[leaf + 1], turns);
  leafMeans.fill(leafMeans[leafCount - 1], leafCount);
  // The tree is the better start if some values are outliers; the other start is better elsewhere.
  const found = [await improve(leafMeans, values, turns), await improve(companded(values), values, turns)];
  found.sort((a, b) => a.error - b.error);
  return new Codebook(found[0].means);
}

/** The distinct values of an ascending list if there are at most 256; else null. */
async function fewDifferent(values: Float32Array, turns: Turns): Promise<number[] | null> {
  const different: number[] = [];
  for (let i = 0; i < values.length; i++) {
    if (i % ROWS_AT_ONCE === 0) await turns.give();
    if (i > 0 && values[i] === values[i - 1]) continue;
    if (different.length === SIZE) return null;
    different.push(values[i]);
  }
  return different;
}

/** Iterates k-means; returns the means, ascending, and the sum of squared differences. */
async function improve(
  start: Float64Array,
  values: Float32Array,
  turns: Turns,
): Promise<{ means: Float64Array; error: number }> {
  const means = start.slice();
  let error = 0;
  for (let round = 0; round < ROUNDS; round++) {
    let from = 0;
    error = 0;
    for (let i = 0; i < SIZE; i++) {
      const end = i < SIZE - 1 ? firstAbove(values, (means[i] + means[i + 1]) / 2) : values.length;
      if (from < end) {
        means[i] = await meanOf(values, from, end, turns);
        if (round === ROUNDS - 1) for (let k = from; k < end; k++) error += (values[k] - means[i]) ** 2;
      }
      from = end;
    }
  }
  return { means, error };
}

/**
 * Initial values for k-means. Their density is proportional to the cube root of the data's density,
 * which is optimal for many values (Panter and Dite). With bins of equal counts, a bin of width w
 * thus gets a share proportional to w^⅔.
 */
function companded(values: Float32Array): Float64Array {
  const at = (interval: number) => values[Math.floor((interval * (values.length - 1)) / INTERVALS)];
  const shares = new Float64Array(INTERVALS + 1);
  for (let i = 0; i < INTERVALS; i++) shares[i + 1] = shares[i] + Math.cbrt(at(i + 1) - at(i)) ** 2;
  let interval = 0;
  return Float64Array.from({ length: SIZE }, (_, k) => {
    const share = ((k + 0.5) / SIZE) * shares[INTERVALS];
    while (interval < INTERVALS - 1 && shares[interval + 1] < share) interval++;
    const part = (share - shares[interval]) / (shares[interval + 1] - shares[interval]);
    return at(interval) + (at(interval + 1) - at(interval)) * part;
  });
}

async function meanOf(values: Float32Array, from: number, to: number, turns: Turns): Promise<number> {
  let sum = 0;
  for (let start = from; start < to; start += ROWS_AT_ONCE) {
    const end = Math.min(to, start + ROWS_AT_ONCE);
    for (let i = start; i < end; i++) sum += values[i];
    await turns.give();
  }
  return sum / (to - from);
}

/** Index of the first of ascending values above `limit`. */
function firstAbove(values: Float32Array, limit: number): number {
  let low = 0;
  let high = values.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] > limit) high = middle;
    else low = middle + 1;
  }
  return low;
}
