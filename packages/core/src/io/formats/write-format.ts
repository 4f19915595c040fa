import { InvalidArgumentError } from '../../data/errors.ts';
import type { Harmonics } from '../../data/packing/harmonics.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { Turns } from '../../data/turns.ts';
import type { PieceFacts } from './piece-facts.ts';

/** How a scene is written: an end, and reports meanwhile. */
export interface WriteOptions {
  /** Ends the writing, which then rejects with the signal's reason. */
  readonly signal?: AbortSignal;
  /** Told how much of the work is done, from 0 to 1. */
  readonly onProgress?: (fraction: number) => void;
  /**
   * Told what the format cannot keep of these splats, a sentence each, with figures and what to do:
   * steps of positions that are coarse beside the splats' sizes, sizes and colours beyond its range,
   * harmonics below its steps.
   */
  readonly onNote?: (note: string) => void;
}

/**
 * Writes all splats of a set as a file.
 *
 * Rejects with `InvalidArgumentError` 'set' if the format cannot hold them, or the signal's reason.
 */
export type WriteFormat = (
  set: SplatSet<Harmonics>,
  options: WriteOptions,
) => Promise<Uint8Array<ArrayBuffer>>;

/** Splats that come in pieces, and can be read again and again. */
export interface SplatPieces {
  readonly facts: PieceFacts;
  /** Reads all from the first on. Their memory is used again once `onPiece` has resolved. */
  read(onPiece: (piece: SplatSet<Harmonics>) => Promise<void>): Promise<void>;
}

/** Takes the next bytes of a file, which are not changed any more. */
export type PutBytes = (bytes: Uint8Array<ArrayBuffer>) => Promise<void>;

/** Writes splats as a file, neither of them in memory. Rejects as `WriteFormat`, `read`, `put`. */
export type WritePieces = (pieces: SplatPieces, options: WriteOptions, put: PutBytes) => Promise<void>;

/** Reads all pieces, and tells the progress. `work` is given the number of splats before each. */
export async function readInTurns(
  { facts, read }: SplatPieces,
  { signal, onProgress }: WriteOptions,
  work: (piece: SplatSet<Harmonics>, before: number) => Promise<void> | void,
): Promise<void> {
  let before = 0;
  await read(async (piece) => {
    signal?.throwIfAborted();
    await work(piece, before);
    before += piece.count;
    onProgress?.(before / facts.count);
  });
}

/** Options of a part of the work: its own progress, from 0 to 1, is `from` to `to` of the whole. */
export function partOfProgress({ signal, onProgress }: WriteOptions, from: number, to: number): WriteOptions {
  return { signal, onProgress: onProgress && ((fraction) => onProgress(from + (to - from) * fraction)) };
}

/** Rows between two looks at the clock. */
const ROWS_AT_ONCE = 1024;

/**
 * Lets `work` write rows `from` to before `to`, until all `count` are; gives the event loop turns.
 *
 * @param until fraction for `onProgress` at the end; less than 1 where other work follows.
 *
 * Rejects with the signal's reason once it aborts.
 */
export async function writeInTurns(
  count: number,
  { signal, onProgress }: WriteOptions,
  work: (from: number, to: number) => void,
  until = 1,
): Promise<void> {
  const turns = new Turns(signal);
  for (let from = 0; from < count; from += ROWS_AT_ONCE) {
    await turns.give();
    const to = Math.min(count, from + ROWS_AT_ONCE);
    work(from, to);
    onProgress?.((until * to) / count);
  }
  signal?.throwIfAborted();
}

/**
 * Memory for a file.
 *
 * @throws InvalidArgumentError 'set' if there is none.
 */
export function fileMemory(byteCount: number): Uint8Array<ArrayBuffer> {
  try {
    return new Uint8Array(byteCount);
  } catch (cause) {
    if (!(cause instanceof RangeError)) throw cause;
    const message = `These splats make a file of ${byteCount} bytes, for which there is no memory. Write fewer of them, or fewer bands of harmonics.`;
    throw new InvalidArgumentError('set', message);
  }
}
