import { wrongArgument } from '../../../data/given.ts';
import { clampCoefficient } from '../../../data/layout/half.ts';
import { principalAxes } from '../../../data/math/principal-axes.ts';
import { type Harmonics, readCoefficients } from '../../../data/packing/harmonics.ts';
import { type HarmonicsPalette, MAX_PALETTE_ENTRIES } from '../../../data/packing/harmonics-palette.ts';
import { leafOf, ROWS_AT_ONCE, type RowTree, splitRows } from '../../../data/packing/split-rows.ts';
import { coefficientsPerSplat } from '../../../data/splats/splat-set.ts';
import { Turns } from '../../../data/turns.ts';
import { EntrySearch, squaredDistance } from './entry-search.ts';

export interface ClusterOptions {
  /** Most entries, 1 to MAX_PALETTE_ENTRIES; fewer if there are fewer distinct harmonics. */
  readonly entryCount: number;
  /**
   * Most splats from which entries are computed: bounds memory. Default: 2²⁰. Other splats are
   * assigned at the end.
   */
  readonly mostSampled?: number;
  /** Aborts the work, which then rejects with the signal's reason. */
  readonly signal?: AbortSignal;
  /** Called with the fraction of the work that is done, from 0 to 1. */
  readonly onProgress?: (fraction: number) => void;
}

/** A sample of only 16 splats per entry would miss rare harmonics, which dominate the error. */
const MOST_SAMPLED = 2 ** 20;
/** Splats from which the principal axes of harmonics are computed. */
const AXES_SAMPLE = 2 ** 14;
const MOST_ROUNDS = 12;
/** Iterations end when the error decreases by less than this fraction. */
const LEAST_GAIN = 0.002;
/** Multiple of the mean squared distance from which a splat gets a longer search. */
const FAR = 4;
/** Progress before the first iteration, and before the last pass. */
const PROGRESS = { rounds: 0.2, lastPass: 0.9 } as const;

/**
 * Computes a palette for the harmonics of `count` splats by k-means; the error is the sum of
 * squared differences of coefficients. If there are at most as many distinct harmonics as entries,
 * the palette has all of them. Equal harmonics give equal palettes: nothing is random.
 *
 * A tree of cuts gives the initial entries (`splitRows`), in time N·log E. In each iteration,
 * splats move to nearer entries, and entries to the means of their splats. Only neighbours of a
 * splat's entry are candidates. Coordinates are along the principal axes, so that a few values
 * suffice to exclude an entry. Finding the neighbours takes time E^1.5; comparing all pairs would
 * take N·E.
 *
 * Memory beyond the palette: 4 bytes per coefficient of the sampled splats, 20 per coefficient of
 * the entries, and 400 per entry.
 *
 * Rejects with InvalidArgumentError 'entryCount', or with the signal's reason.
 */
export async function clusterHarmonics(
  harmonics: Harmonics,
  count: number,
  { entryCount, mostSampled = MOST_SAMPLED, signal, onProgress }: ClusterOptions,
): Promise<HarmonicsPalette> {
  if (!Number.isInteger(entryCount) || entryCount < 1 || entryCount > MAX_PALETTE_ENTRIES) {
    throw wrongArgument('entryCount', entryCount, `a whole number from 1 to ${MAX_PALETTE_ENTRIES}`);
  }
  const { degree } = harmonics;
  const length = coefficientsPerSplat(degree);
  const indices = new Uint16Array(count);
  if (length === 0 || count === 0) return { degree, entries: new Float32Array(0), indices };
  const turns = new Turns(signal);
  const sampleCount = Math.min(count, mostSampled);
  const ids = sampleOf(count, sampleCount);
  const frame = await Frame.of(harmonics, ids, turns);
  const rows = new Float32Array(sampleCount * length);
  for (let i = 0; i < sampleCount; i++) {
    frame.turn(harmonics, ids[i], rows, i * length);
    if (i % ROWS_AT_ONCE === 0) await turns.give();
  }
  const tree = await splitRows(rows, ids, length, entryCount, turns);
  const clusters = new Clusters(rows, length, tree);
  let search: EntrySearch | null = null;
  let lastError = Number.POSITIVE_INFINITY;
  for (let round = 0; round < MOST_ROUNDS; round++) {
    const { rounds, lastPass } = PROGRESS;
    onProgress?.(rounds + ((lastPass - rounds) * round) / MOST_ROUNDS);
    await clusters.moveEntries(turns);
    const reaches = await clusters.reaches(turns);
    const { entries } = clusters;
    search = await EntrySearch.among(entries, length, tree.cells, reaches, search, turns);
    const error = await clusters.moveRows(search, (FAR * lastError) / sampleCount, turns);
    if (error >= lastError * (1 - LEAST_GAIN)) break;
    lastError = error;
  }
  onProgress?.(PROGRESS.lastPass);
  for (let i = 0; i < sampleCount; i++) indices[ids[i]] = clusters.owners[i];
  if (sampleCount < count) {
    await clusters.moveEntries(turns);
    const isSampled = new Uint8Array(count);
    for (const id of ids) isSampled[id] = 1;
    const others = Uint32Array.from({ length: count }, (_, i) => i).filter((i) => isSampled[i] === 0);
    await assignOthers(harmonics, others, frame, tree, clusters, search, indices, turns);
  }
  const entries = await entriesOf(harmonics, indices, clusters.entryCount, turns);
  onProgress?.(1);
  return { degree, entries, indices };
}

/**
 * `sampleCount` of `count` splat indices, ascending: all, or at irregular steps, which avoid
 * aliasing with periodic data.
 */
function sampleOf(count: number, sampleCount: number): Uint32Array {
  const goldenRatio = (Math.sqrt(5) - 1) / 2;
  return Uint32Array.from({ length: sampleCount }, (_, i) =>
    Math.floor(((i + ((i * goldenRatio) % 1)) * count) / sampleCount),
  );
}

/** Coordinates of harmonics along their principal axes, relative to their mean. */
class Frame {
  readonly #length: number;
  readonly #mean: Float64Array;
  readonly #axes: Float64Array;
  readonly #values: Float64Array;

  private constructor(length: number, mean: Float64Array, axes: Float64Array) {
    this.#length = length;
    this.#mean = mean;
    this.#axes = axes;
    this.#values = new Float64Array(length);
  }

  static async of(harmonics: Harmonics, ids: Uint32Array, turns: Turns): Promise<Frame> {
    const length = coefficientsPerSplat(harmonics.degree);
    const step = Math.ceil(ids.length / AXES_SAMPLE);
    const values = new Float64Array(length);
    const mean = new Float64Array(length);
    const used = Math.ceil(ids.length / step);
    for (let i = 0; i < ids.length; i += step) {
      readClamped(harmonics, ids[i], values);
      for (let k = 0; k < length; k++) mean[k] += values[k] / used;
    }
    const covariance = new Float64Array(length * length);
    for (let i = 0; i < ids.length; i += step) {
      readClamped(harmonics, ids[i], values);
      for (let k = 0; k < length; k++) values[k] -= mean[k];
      for (let p = 0; p < length; p++)
        for (let q = p; q < length; q++) covariance[p * length + q] += values[p] * values[q];
      if (i % (ROWS_AT_ONCE / 8) === 0) await turns.give();
    }
    for (let p = 0; p < length; p++)
      for (let q = 0; q < p; q++) covariance[p * length + q] = covariance[q * length + p];
    return new Frame(length, mean, principalAxes(covariance, length));
  }

  /** Writes the coordinates of a splat's harmonics into `rows` from `at` on. */
  turn(harmonics: Harmonics, splat: number, rows: Float32Array, at: number): void {
    const values = this.#values;
    const axes = this.#axes;
    const length = this.#length;
    readClamped(harmonics, splat, values);
    for (let k = 0; k < length; k++) values[k] -= this.#mean[k];
    for (let axis = 0; axis < length; axis++) {
      let sum = 0;
      for (let k = 0; k < length; k++) sum += axes[axis * length + k] * values[k];
      rows[at + axis] = sum;
    }
  }
}

/** Rows and their assigned entries. */
class Clusters {
  readonly entryCount: number;
  /** Entries as of the last `moveEntries`. */
  readonly entries: Float32Array;
  /** Entry index per row. */
  readonly owners: Uint16Array;
  readonly #rows: Float32Array;
  readonly #length: number;
  /** Sum of the rows of each entry. */
  readonly #sums: Float64Array;
  readonly #counts: Uint32Array;

  constructor(rows: Float32Array, length: number, { leafCount, starts }: RowTree) {
    this.entryCount = leafCount;
    this.entries = new Float32Array(leafCount * length);
    this.owners = new Uint16Array(rows.length / length);
    this.#rows = rows;
    this.#length = length;
    this.#sums = new Float64Array(leafCount * length);
    this.#counts = new Uint32Array(leafCount);
    for (let leaf = 0; leaf < leafCount; leaf++)
      for (let i = starts[leaf]; i < starts[leaf + 1]; i++) this.#give(i, leaf, 1);
  }

  /** Moves entries to the means of their rows; entries without rows stay. */
  async moveEntries(turns: Turns): Promise<void> {
    const length = this.#length;
    for (let entry = 0; entry < this.entryCount; entry++) {
      const count = this.#counts[entry];
      for (let k = entry * length; k < (entry + 1) * length && count > 0; k++)
        this.entries[k] = this.#sums[k] / count;
      if (entry % ROWS_AT_ONCE === 0) await turns.give();
    }
  }

  /** Squared distance of the farthest row of each entry. */
  async reaches(turns: Turns): Promise<Float64Array> {
    const length = this.#length;
    const { entries, owners } = this;
    const reaches = new Float64Array(this.entryCount);
    for (let i = 0; i < owners.length; i++) {
      const owner = owners[i];
      const bound = Number.POSITIVE_INFINITY;
      const distance = squaredDistance(this.#rows, i * length, entries, owner * length, length, bound);
      if (distance > reaches[owner]) reaches[owner] = distance;
      if (i % ROWS_AT_ONCE === 0) await turns.give();
    }
    return reaches;
  }

  /** Reassigns rows to nearer entries; returns the sum of squared distances. */
  async moveRows(search: EntrySearch, farDistance: number, turns: Turns): Promise<number> {
    const length = this.#length;
    const { owners } = this;
    let error = 0;
    for (let i = 0; i < owners.length; i++) {
      const owner = owners[i];
      const entry = search.nearest(this.#rows, i * length, owner, farDistance);
      error += search.distance;
      if (entry !== owner) {
        this.#give(i, owner, -1);
        this.#give(i, entry, 1);
      }
      if (i % ROWS_AT_ONCE === 0) await turns.give();
    }
    return error;
  }

  /** Adds a row to the sum of an entry, or subtracts it. */
  #give(row: number, entry: number, sign: 1 | -1): void {
    const length = this.#length;
    const [from, to] = [row * length, entry * length];
    for (let k = 0; k < length; k++) this.#sums[to + k] += sign * this.#rows[from + k];
    this.#counts[entry] += sign;
    this.owners[row] = entry;
  }
}

/** Assigns splats outside of the sample to entries, and writes the entries into `indices`. */
async function assignOthers(
  harmonics: Harmonics,
  splats: Uint32Array,
  frame: Frame,
  tree: RowTree,
  { entries, entryCount }: Clusters,
  before: EntrySearch | null,
  indices: Uint16Array,
  turns: Turns,
): Promise<void> {
  const length = coefficientsPerSplat(harmonics.degree);
  // These splats may be farther from an entry than any sampled row.
  const reaches = new Float64Array(entryCount).fill(Number.POSITIVE_INFINITY);
  const search = await EntrySearch.among(entries, length, tree.cells, reaches, before, turns);
  const row = new Float32Array(length);
  for (let i = 0; i < splats.length; i++) {
    frame.turn(harmonics, splats[i], row, 0);
    indices[splats[i]] = search.nearest(row, 0, leafOf(tree, row), 0);
    if (i % ROWS_AT_ONCE === 0) await turns.give();
  }
}

/** The mean of each entry's splats. Empty entries are removed, and `indices` are renumbered. */
async function entriesOf(
  harmonics: Harmonics,
  indices: Uint16Array,
  entryCount: number,
  turns: Turns,
): Promise<Float32Array> {
  const length = coefficientsPerSplat(harmonics.degree);
  const counts = new Uint32Array(entryCount);
  for (const index of indices) counts[index]++;
  const placeOf = new Uint16Array(entryCount);
  let used = 0;
  for (let entry = 0; entry < entryCount; entry++) {
    placeOf[entry] = used;
    if (counts[entry] > 0) counts[used++] = counts[entry];
  }
  const sums = new Float64Array(used * length);
  const values = new Float64Array(length);
  for (let i = 0; i < indices.length; i++) {
    const entry = placeOf[indices[i]];
    indices[i] = entry;
    readClamped(harmonics, i, values);
    for (let k = 0; k < length; k++) sums[entry * length + k] += values[k];
    if (i % ROWS_AT_ONCE === 0) await turns.give();
  }
  const entries = new Float32Array(used * length);
  for (let entry = 0; entry < used; entry++) {
    for (let k = entry * length; k < (entry + 1) * length; k++) entries[k] = sums[k] / counts[entry];
    if (entry % ROWS_AT_ONCE === 0) await turns.give();
  }
  return entries;
}

function readClamped(harmonics: Harmonics, splat: number, values: Float64Array): void {
  readCoefficients(harmonics, splat, values);
  for (let k = 0; k < values.length; k++) values[k] = clampCoefficient(values[k]);
}
