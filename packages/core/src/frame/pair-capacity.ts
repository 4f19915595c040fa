import { SHADER_CONSTANTS } from '../layout/constants.ts';
import { LEAST_USE, RecentPeak, ROOM_PERIOD_MS } from './recent-peak.ts';

/**
 * Bytes per pair that the tiles hold: key and record after the sort, and a bit per tile of a bin, which take the place of key and
 * record before the sort.
 */
export const PAIR_BYTES = 2 * 4 + (SHADER_CONSTANTS.BIN_TILES * SHADER_CONSTANTS.BIN_TILES) / 8;
/** Most bytes that the tiles of a view may take, unless the caller says otherwise: 33 million pairs. */
export const DEFAULT_TILE_BUDGET_BYTES = 2 ** 29;
/** Spare room, so that a moving camera does not need larger buffers every frame. */
const HEADROOM = 1.35;
/** More room is made before it is needed: when a frame leaves less than this much spare. */
const LEAST_HEADROOM = 1.12;
/** Bins per splat that room is made for before the first frame, each up to a number of pairs: 2 MB, then 16 MB. */
const FIRST_GUESSES = [
  { binsPerSplat: 4, mostPairs: 1 << 17 },
  { binsPerSplat: 2, mostPairs: 1_000_000 },
] as const;
/** Room is made in steps of this many pairs, so that small changes need none. */
const STEP = 1 << 14;
/** Room, which may have been a guess, is judged once after this many frames: by then some have been measured. */
const FRAMES_TO_JUDGE = 12;
/** It stays unless what is needed takes less than this share of it. */
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

/** Generous where that costs little. Where it is too low, quads draw the frame, and the next one has room. */
function firstGuess(visibleCapacity: number): number {
  const guesses = FIRST_GUESSES.map(({ binsPerSplat, mostPairs }) =>
    Math.min(binsPerSplat * visibleCapacity, mostPairs),
  );
  return Math.max(visibleCapacity, ...guesses);
}

/** The room for pairs that the frames of a view need, by what its recent frames needed. */
export class PairRoom {
  /** Numbers of pairs of recent frames. */
  readonly #needed = new RecentPeak(ROOM_PERIOD_MS);
  /** Most splats that there was room for in those frames. */
  #visibleCapacity = 0;
  /** Frames since room was made. */
  #frames = 0;

  /** Takes the number of pairs of a frame whose statistics arrived at `atMs`. */
  take(neededPairs: number, atMs: number): void {
    this.#needed.take(neededPairs, atMs);
  }

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
    const growth = this.#visibleCapacity > 0 ? Math.max(1, visibleCapacity / this.#visibleCapacity) : 1;
    const needed = Math.ceil(growth * this.#needed.value) || null;
    const capacityFrom = (room: number) => pairCapacity(room, needed, visibleCapacity, mostPairs);
    if (canStay && ++this.#frames === FRAMES_TO_JUDGE) {
      const fitting = capacityFrom(0);
      if (fitting < GOOD_GUESS * current) return fitting;
    }
    return capacityFrom(current);
  }

  /** Notes that room was made for frames of up to so many visible splats. */
  made(visibleCapacity: number): void {
    this.#frames = 0;
    this.#visibleCapacity = Math.max(this.#visibleCapacity, visibleCapacity);
  }
}
