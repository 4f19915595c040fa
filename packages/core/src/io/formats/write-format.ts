import { InvalidArgumentError } from '../../data/errors.ts';
import type { Harmonics } from '../../data/packing/harmonics.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { Turns } from '../../data/turns.ts';
import type { PieceFacts } from './rows/piece-facts.ts';

/** Abort signal and callbacks of a write. */
export interface WriteOptions {
  /** Aborts the write, which then rejects with the signal's reason. */
  readonly signal?: AbortSignal;
  /** Called with the fraction of the work that is done, from 0 to 1. */
  readonly onProgress?: (fraction: number) => void;
  /**
   * Called once per loss of the format, with a sentence that has figures and advice. Examples:
   * position steps coarser than the splats, sizes and colours out of range, harmonics below the
   * steps.
   */
  readonly onNote?: (note: string) => void;
}

/**
 * Writes all splats of a set as a file.
 *
 * Rejects with `InvalidArgumentError` 'set' if the format cannot represent them, or with the
 * signal's reason.
 */
export type WriteFormat = (
  set: SplatSet<Harmonics>,
  options: WriteOptions,
) => Promise<Uint8Array<ArrayBuffer>>;

/** Splats in pieces that can be read repeatedly. */
export interface SplatPieces {
  readonly facts: PieceFacts;
  /** Reads all pieces in order. The memory of a piece is reused once `onPiece` has resolved. */
  read(onPiece: (piece: SplatSet<Harmonics>) => Promise<void>): Promise<void>;
}

/** Takes the next bytes of a file. The caller does not change them afterwards. */
export type PutBytes = (bytes: Uint8Array<ArrayBuffer>) => Promise<void>;

/**
 * Writes splats as a file; neither is held in memory as a whole. Rejects as `WriteFormat`, `read`,
 * `put`.
 */
export type WritePieces = (pieces: SplatPieces, options: WriteOptions, put: PutBytes) => Promise<void>;

/** Reads all pieces and reports progress. `work` receives a piece and the number of splats before it. */
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

/** Options for a part of the work, whose progress of 0 to 1 maps to `from` to `to` of the whole. */
export function partOfProgress({ signal, onProgress }: WriteOptions, from: number, to: number): WriteOptions {
  return { signal, onProgress: onProgress && ((fraction) => onProgress(from + (to - from) * fraction)) };
}

/** Rows between two checks of the clock. */
const ROWS_AT_ONCE = 1024;

/**
 * Calls `work` for ranges of rows, `from` to before `to`, until all `count` rows are written.
 * Yields to the event loop in between.
 *
 * @param until progress at the end; below 1 if other work follows.
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
 * Allocates memory for a file.
 *
 * @throws InvalidArgumentError 'set' if the allocation fails.
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
