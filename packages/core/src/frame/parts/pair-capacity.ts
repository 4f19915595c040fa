import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { LEAST_USE, RecentPeak } from '../plan/recent-peak.ts';

/**
 * Bytes per pair that the tiles hold: key and record after the sort, and a bit per tile of a bin,
 * which take the place of key and record before the sort.
 */
export const PAIR_BYTES = 2 * 4 + (SHADER_CONSTANTS.BIN_TILES * SHADER_CONSTANTS.BIN_TILES) / 8;
/** Most bytes that the tiles of a view may take by default: 33 million pairs. */
export const DEFAULT_TILE_BUDGET_BYTES = 2 ** 29;
/** Spare room, so that a moving camera does not need larger buffers every frame. */
const HEADROOM = 1.35;
/** More room is made before it is needed: when a frame leaves less than this much spare. */
const LEAST_HEADROOM = 1.12;
/** Room before the first frame is for four bins per splat up to this many pairs, 2 MB. */
const MOST_PAIRS_OF_FOUR = 1 << 17;
/** Then it is for two bins per splat up to this many, 16 MB. */
const MOST_PAIRS_OF_TWO = 1_000_000;
/** Room is made in steps of this many pairs, so that small changes need none. */
const STEP = 1 << 14;
/** Room, maybe a guess, is judged once after this many frames: some have been measured by then. */
const FRAMES_TO_JUDGE = 12;
/** It stays unless the need takes less than this share of it. */
const GOOD_GUESS = 0.85;

/**
 * Returns the number of pairs to make room for.
 *
 * @param current number of pairs that there is room for already; kept while it suits.
 * @param needed the largest of the recent frames' numbers of pairs; null before any is known.
 * @param visibleCapacity upper bound of the number of visible splats.
 * @param mostPairs number of pairs that budget and device allow.
 */
export function pairCapacity(
  current: number,
  needed: number | null,
  visibleCapacity: number,
  mostPairs: number,
): number {
  const expected = needed ?? firstGuess(visibleCapacity);
  if (
    current > 0 &&
    current <= mostPairs &&
    LEAST_HEADROOM * expected <= current &&
    expected >= LEAST_USE * current
  )
    return current;
  const roomy = Math.ceil((HEADROOM * expected + 1) / STEP) * STEP;
  return Math.min(roomy, Math.max(mostPairs, 1));
}

/** Generous where that is cheap. If it is too low, bins are larger, and the next frame has room. */
function firstGuess(visibleCapacity: number): number {
  return Math.max(
    visibleCapacity,
    Math.min(4 * visibleCapacity, MOST_PAIRS_OF_FOUR),
    Math.min(2 * visibleCapacity, MOST_PAIRS_OF_TWO),
  );
}

/** Largest number of pairs of a view's recent frames, and the room to make for the next. */
export class PairRoom extends RecentPeak {
  /** Largest `visibleCapacity` of the recent frames. */
  #visibleCapacity = 0;
  /** Frames since room was made. */
  #frames = 0;

  /**
   * Returns the number of pairs to make room for in the next frame.
   *
   * @param current number of pairs that there is room for already.
   * @param visibleCapacity upper bound of the number of visible splats.
   * @param mostPairs number of pairs that budget and device allow.
   * @param canStay whether the room, if its pairs suit, can stay as it is.
   */
  next(current: number, visibleCapacity: number, mostPairs: number, canStay: boolean): number {
    // Room for more splats is made before they are seen, as when more of a file has arrived.
    const growth = Math.max(1, visibleCapacity / (this.#visibleCapacity || visibleCapacity));
    const needed = Math.ceil(growth * this.value) || null;
    const isJudged = canStay && ++this.#frames === FRAMES_TO_JUDGE;
    const fitting = pairCapacity(0, needed, visibleCapacity, mostPairs);
    if (isJudged && fitting < GOOD_GUESS * current) return fitting;
    return pairCapacity(current, needed, visibleCapacity, mostPairs);
  }

  /** Notes that room was made for frames of up to so many visible splats. */
  made(visibleCapacity: number): void {
    this.#frames = 0;
    this.#visibleCapacity = Math.max(this.#visibleCapacity, visibleCapacity);
  }
}
