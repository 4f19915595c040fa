import { checkKind, given, wrongArgument } from '../../../data/given.ts';
import { LEVEL_CONSTANTS } from '../../../data/layout/level-structs.ts';
import type { Bounds } from '../../../data/packing/packed-cloud.ts';
import type { RecordRun } from './brick-records.ts';
import { BOUNDS_WORDS, type BrickResult, type SplatsTask } from './brick-tasks.ts';

const { CELL_CHILDREN } = LEVEL_CONSTANTS;

/** Some records in a file. */
export interface StoredRun {
  readonly run: RecordRun;
  /** First byte. */
  readonly at: number;
  /** See `sumOf`; undefined where it is not known. */
  readonly sum?: number;
}

/** Splats came, and are in the file `arrived`. */
export interface ArrivedEntry {
  readonly kind: 'arrived';
  /** Rows of the source until then, those that hold no splats among them. */
  readonly rows: number;
  readonly runs: readonly StoredRun[];
  /** Of each of these runs. */
  readonly bounds: readonly Bounds[];
  /** What sets said about antialiasing; null: nothing. */
  readonly told: readonly (boolean | null)[];
  /** Splats that the origin is taken from: see `PositionSample.addValues`. */
  readonly sample: Float64Array;
}

/** Records were divided into the buckets of the file `bucketsName(depth, first)`. */
export interface DividedEntry {
  readonly kind: 'divided';
  /** Digits by which they had been told apart before. */
  readonly depth: number;
  /** Number of their first splat in storage order. */
  readonly first: number;
  /** Splats of each bucket. */
  readonly sizes: readonly number[];
}

/** Bricks of splats, in the files of the lowest level. */
export interface StoredSplats {
  readonly made: Omit<BrickResult<SplatsTask>, 'bytes' | 'roots'>;
  /** First byte of the bricks. */
  readonly at: number;
  readonly byteCount: number;
  /** See `sumOf`; undefined where it is not known. */
  readonly sum?: number;
}

/** Bricks were made. */
export interface MadeEntry extends StoredSplats {
  readonly kind: 'made';
  /** The splats they were made of, in storage order; null: those that wait for others of their brick. */
  readonly range: { readonly first: number; readonly count: number } | null;
}

export type JournalEntry = ArrivedEntry | DividedEntry | MadeEntry;

/** Finished work of a writer, for another one that goes on with it in the same files. */
export interface BrickJournal {
  /** What was noted, from the first on. */
  entries(): AsyncIterable<JournalEntry>;
  /** Resolves once the entry lasts, and all that was written to files with names before. */
  note(entry: JournalEntry): Promise<void>;
}

/** @throws InvalidArgumentError for what no writer has noted, as storage that lost a part has it. */
export function checkEntry(entry: JournalEntry): void {
  const { kind } = given(entry, { kind: 'a string' }, 'entry');
  const whole = 'a whole number';
  switch (entry.kind) {
    case 'divided': {
      const { sizes } = given(entry, { depth: whole, first: whole, sizes: 'a list' }, 'entry');
      for (const size of sizes) checkKind('entry.sizes', size, whole);
      return;
    }
    case 'made': {
      const { made, range } = given(entry, { at: whole, byteCount: whole }, 'entry');
      const columns = ['samples', 'sizes', 'bounds', 'largestScales', 'errors'] as const;
      given(made, { first: whole, fragments: 'a list' }, 'entry.made');
      given(
        made.rounding,
        {
          positions: 'an object',
          float32Positions: 'an object',
          scales: 'an object',
          colors: 'an object',
          harmonics: 'an object',
        },
        'entry.made.rounding',
      );
      for (const name of columns) checkKind(`entry.made.${name}`, made[name], 'a typed array');
      const { length } = made.errors;
      const lengths = {
        bounds: BOUNDS_WORDS * length,
        largestScales: length,
        sizes: 2 * Math.ceil(length / CELL_CHILDREN),
      };
      for (const [name, expected] of Object.entries(lengths)) {
        const found = made[name as keyof typeof lengths].length;
        if (found !== expected)
          throw wrongArgument(`entry.made.${name}.length`, found, `${expected}, as of ${length} cells`);
      }
      for (const fragment of made.fragments)
        given(fragment, { first: whole, words: 'a typed array' }, 'entry.made.fragments');
      if (!range) return;
      given(range, { first: whole, count: whole }, 'entry.range');
      // One of no splats would lead on to itself.
      if (range.count === 0) throw wrongArgument('entry.range.count', 0, 'above 0');
      return;
    }
    case 'arrived': {
      const { runs, bounds } = entry;
      const lists = { runs: 'a list', bounds: 'a list', told: 'a list', sample: 'a typed array' } as const;
      given(entry, { rows: whole, ...lists }, 'entry');
      for (const each of runs) {
        const { run } = given(each, { at: whole }, 'entry.runs');
        given(run, { count: whole, words: whole, origin: 'a list', harmonics: 'an object' }, 'run');
      }
      for (const each of bounds) given(each, { min: 'a list', max: 'a list' }, 'entry.bounds');
      if (bounds.length === runs.length) return;
      throw wrongArgument('entry.bounds.length', bounds.length, `${runs.length}, one for each run`);
    }
    default:
      throw wrongArgument('entry.kind', kind, 'arrived, divided or made');
  }
}

export function bucketsName(depth: number, first: number): string {
  return `buckets-${depth}-${first}`;
}

/** Splats of which bricks are made, in ranges of storage order. */
export class MadeRanges {
  readonly #counts = new Map<number, number>();

  add({ first, count }: { readonly first: number; readonly count: number }): void {
    this.#counts.set(first, count);
  }

  /** Whether they hold all of `count` splats from `first` on. */
  hold(first: number, count: number): boolean {
    let at = first;
    while (at < first + count) {
      const next = this.#counts.get(at);
      if (next === undefined) return false;
      at += next;
    }
    return true;
  }
}
