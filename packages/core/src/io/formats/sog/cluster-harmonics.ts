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
  /** Most entries, 1 to MAX_PALETTE_ENTRIES; there are fewer if fewer harmonics differ. */
  readonly entryCount: number;
  /** Most splats to find entries from, a bound on memory; default 2²⁰. Others join at the end. */
  readonly mostSampled?: number;
  /** Ends the work, which then rejects with the signal's reason. */
  readonly signal?: AbortSignal;
  /** Told how much of the work is done, from 0 to 1. */
  readonly onProgress?: (fraction: number) => void;
}

/** With 16 for each entry, rare harmonics, which make most of the error, would be missed. */
const MOST_SAMPLED = 2 ** 20;
/** Splats that tell along which axes harmonics vary. */
const AXES_SAMPLE = 2 ** 14;
const MOST_ROUNDS = 12;
/** A round that takes less than this part off the error is the last. */
const LEAST_GAIN = 0.002;
/** A splat at this many times the mean squared distance from its entry gets a longer search. */
const FAR = 4;
/** Part of the work that is done before the first round, and before the last pass. */
const PROGRESS = { rounds: 0.2, lastPass: 0.9 } as const;

/**
 * Finds a palette for the harmonics of `count` splats: k-means, with squares of differences of
 * coefficients as the error. If no more harmonics differ than there are entries, the palette
 * has each of them. Equal harmonics give equal palettes: nothing is random.
 *
 * A tree of cuts gives the first entries (`splitRows`), in time N·log E. In each round then, splats
 * move to nearer entries, and entries to the means of their splats. Only neighbours of a splat's
 * entry are looked at, in coordinates along the axes of largest variance, where a few values tell
 * that an entry is too far away; finding the neighbours takes time E^1.5. Comparing each splat with
 * each entry would take N·E. Memory beyond the palette: 4 bytes for each coefficient of the splats
 * of the sample, 20 for each of the entries, and 400 for each entry.
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
 * Numbers of `sampleCount` of `count` splats, ascending: all, or at uneven steps, so that nothing
 * that recurs is missed.
 */
function sampleOf(count: number, sampleCount: number): Uint32Array {
  const goldenRatio = (Math.sqrt(5) - 1) / 2;
  return Uint32Array.from({ length: sampleCount }, (_, i) =>
    Math.floor(((i + ((i * goldenRatio) % 1)) * count) / sampleCount),
  );
}

/** Coordinates along the axes of largest variance of some harmonics, about their mean. */
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

/** Rows with the entry of each. */
class Clusters {
  readonly entryCount: number;
  /** By entry, as of the last `moveEntries`. */
  readonly entries: Float32Array;
  /** By row. */
  readonly owners: Uint16Array;
  readonly #rows: Float32Array;
  readonly #length: number;
  /** Of the rows of each entry. */
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

  /** Squared distance of each entry's farthest row. */
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

  /** To nearer entries; returns the sum of their squared distances. */
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

  /** Adds a row to an entry, or takes it away. */
  #give(row: number, entry: number, sign: 1 | -1): void {
    const length = this.#length;
    const [from, to] = [row * length, entry * length];
    for (let k = 0; k < length; k++) this.#sums[to + k] += sign * this.#rows[from + k];
    this.#counts[entry] += sign;
    this.owners[row] = entry;
  }
}

/** Finds the entries of splats that were not in the sample, and writes them into `indices`. */
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
  // They may be farther from an entry than any row of the sample.
  const reaches = new Float64Array(entryCount).fill(Number.POSITIVE_INFINITY);
  const search = await EntrySearch.among(entries, length, tree.cells, reaches, before, turns);
  const row = new Float32Array(length);
  for (let i = 0; i < splats.length; i++) {
    frame.turn(harmonics, splats[i], row, 0);
    indices[splats[i]] = search.nearest(row, 0, leafOf(tree, row), 0);
    if (i % ROWS_AT_ONCE === 0) await turns.give();
  }
}

/** The mean of each entry's splats. Entries without any are left out; `indices` count the rest. */
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
