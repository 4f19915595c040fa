import { checkKind, given, wrongArgument } from '../../../data/given.ts';
import { LEVEL_CONSTANTS } from '../../../data/layout/level-structs.ts';
import type { Bounds } from '../../../data/packing/packed-cloud.ts';
import type { RecordRun } from './brick-records.ts';
import { BOUNDS_WORDS, type BrickResult, type SplatsTask } from './brick-tasks.ts';

const { CELL_CHILDREN } = LEVEL_CONSTANTS;

/** A byte range of a temporary file that holds records. */
export interface StoredRun {
  readonly run: RecordRun;
  /** Offset of the first byte. */
  readonly at: number;
  /** Checksum by `sumOf`; undefined if unknown. */
  readonly sum?: number;
}

/** Splats were appended to the file `arrived`. */
export interface ArrivedEntry {
  readonly kind: 'arrived';
  /** Rows of the source read so far, including dropped rows. */
  readonly rows: number;
  readonly runs: readonly StoredRun[];
  /** Bounds of each run's splats. */
  readonly bounds: readonly Bounds[];
  /** Antialiasing flags of the sets so far: null if a set has no flag. */
  readonly told: readonly (boolean | null)[];
  /** Sample of positions from which the origin is computed: see `PositionSample.addValues`. */
  readonly sample: Float64Array;
}

/** Records were divided into the buckets of the file `bucketsName(depth, first)`. */
export interface DividedEntry {
  readonly kind: 'divided';
  /** Number of Morton digits by which the records were already divided. */
  readonly depth: number;
  /** Index of their first splat in storage order. */
  readonly first: number;
  /** Number of splats in each bucket. */
  readonly sizes: readonly number[];
}

/** Bricks of splats, in the files of the lowest level. */
export interface StoredSplats {
  readonly made: Omit<BrickResult<SplatsTask>, 'bytes' | 'roots'>;
  /** Offset of the first byte of the bricks. */
  readonly at: number;
  readonly byteCount: number;
  /** Checksum by `sumOf`; undefined if unknown. */
  readonly sum?: number;
}

/** Bricks were encoded. */
export interface MadeEntry extends StoredSplats {
  readonly kind: 'made';
  /** Splats in these bricks, in storage order; null for bricks that were joined from several buckets. */
  readonly range: { readonly first: number; readonly count: number } | null;
}

export type JournalEntry = ArrivedEntry | DividedEntry | MadeEntry;

/** Log of a writer's finished work, so that another writer can resume it in the same files. */
export interface BrickJournal {
  /** All entries, in the order in which they were noted. */
  entries(): AsyncIterable<JournalEntry>;
  /** Resolves once the entry and all earlier writes to named files are durable. */
  note(entry: JournalEntry): Promise<void>;
}

/** @throws InvalidArgumentError if no writer can have noted the entry, as after the storage lost data. */
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
      // An empty range would lead back to itself.
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

/** Ranges of splats, in storage order, whose bricks are finished. */
export class MadeRanges {
  readonly #counts = new Map<number, number>();

  add({ first, count }: { readonly first: number; readonly count: number }): void {
    this.#counts.set(first, count);
  }

  /** Whether the ranges cover all `count` splats from `first` on. */
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
