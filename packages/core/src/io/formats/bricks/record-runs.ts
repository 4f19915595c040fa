import { shWordsPerSplat } from '../../../data/packing/harmonics.ts';
import { BLOB_PRECISION } from '../../../data/packing/precision.ts';
import type { StoredRun } from './brick-journal.ts';
import { type RecordRun, recordWords } from './brick-records.ts';
import { BRICK_LEAVES, type SceneFacts } from './brick-tasks.ts';

/** The final record layout, for a run of `count` splats. */
export function runOf(count: number, { degree, origin }: SceneFacts): RecordRun {
  const { shPrecision: precision } = BLOB_PRECISION;
  const wordsPerSplat = shWordsPerSplat(degree, precision);
  return { count, words: recordWords(degree), origin, harmonics: { degree, precision, wordsPerSplat } };
}

export function countOf(runs: readonly StoredRun[]): number {
  return runs.reduce((sum, { run }) => sum + run.count, 0);
}

/** Groups consecutive runs into batches of at most `most` splats; longer runs are cut. */
export function* batchesOf(runs: readonly StoredRun[], most: number): Generator<StoredRun[], void, void> {
  let batch: StoredRun[] = [];
  let room = most;
  for (const { run, at, sum } of runs) {
    for (let from = 0; from < run.count; ) {
      const count = Math.min(room, run.count - from);
      const isWhole = count === run.count;
      batch.push({ run: { ...run, count }, at: at + 4 * run.words * from, ...(isWhole && { sum }) });
      from += count;
      room -= count;
      if (room > 0) continue;
      yield batch;
      batch = [];
      room = most;
    }
  }
  if (batch.length > 0) yield batch;
}

/**
 * Groups neighbouring digits into buckets of at most this many splats, if possible.
 *
 * @returns the bucket of each digit, and the number of splats in each bucket.
 */
export function bucketsOf(
  counts: Uint32Array,
  most: number,
): { buckets: Uint32Array<ArrayBuffer>; sizes: number[] } {
  const buckets = new Uint32Array(counts.length);
  const sizes = [0];
  for (const [digit, count] of counts.entries()) {
    const last = sizes.length - 1;
    if (sizes[last] > 0 && sizes[last] + count > most) sizes.push(count);
    else sizes[last] += count;
    buckets[digit] = sizes.length - 1;
  }
  return { buckets, sizes };
}

/** Collects the fragments of bricks whose splats lie in several buckets. */
export class Seams {
  readonly #facts: SceneFacts;
  readonly #bricks = new Map<number, { readonly words: Uint32Array<ArrayBuffer>; missing: number }>();

  constructor(facts: SceneFacts) {
    this.#facts = facts;
  }

  /** Adds sorted records. Returns the records of their brick once it is complete. */
  add({ first, words }: { readonly first: number; readonly words: Uint32Array }) {
    const width = recordWords(this.#facts.degree);
    const brick = Math.floor(first / BRICK_LEAVES);
    const start = brick * BRICK_LEAVES;
    const size = Math.min(BRICK_LEAVES, this.#facts.splatCount - start);
    const seam = this.#bricks.get(brick) ?? { words: new Uint32Array(size * width), missing: size };
    seam.words.set(words, (first - start) * width);
    seam.missing -= words.length / width;
    this.#bricks.set(brick, seam);
    if (seam.missing > 0) return null;
    this.#bricks.delete(brick);
    return { records: { run: runOf(size, this.#facts), words: seam.words }, first: start };
  }
}
