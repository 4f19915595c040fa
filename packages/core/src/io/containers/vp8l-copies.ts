import type { Turns } from '../../data/turns.ts';
import { distanceTo, NEIGHBOURS } from './vp8l-format.ts';

/** An image as a sequence of single pixels and copies of earlier pixels. */
export interface Items {
  readonly count: number;
  /** Pixels per item. */
  readonly lengths: Uint16Array;
  /** Encoded distance of each copy; 0 for a single pixel. */
  readonly distanceCodes: Uint32Array;
}

/** An image without copies. */
export function singlePixels(count: number): Items {
  return { count, lengths: new Uint16Array(count).fill(1), distanceCodes: new Uint32Array(count) };
}

/** Shorter copies do not pay off. */
const LEAST_LENGTH = 3;
const MOST_LENGTH = 4096;
/** The largest encodable distance, less the 120 codes of neighbours. */
const MOST_DISTANCE = 2 ** 20 - 120;
const HASH_BITS = 16;
/** Candidates that are tried per pixel. */
const MOST_TRIES = 24;
/** A copy of at least this many pixels ends the search. */
const LONG_ENOUGH = 256;
const PIXELS_AT_ONCE = 4096;

/**
 * Finds repeated pixels by hash chains over pairs of pixels.
 *
 * @param pixelBits estimated bits per single pixel.
 */
export async function copiesOf(
  pixels: Int32Array,
  width: number,
  pixelBits: number,
  turns: Turns,
): Promise<Items> {
  const total = pixels.length;
  const lengths = new Uint16Array(total);
  const distanceCodes = new Uint32Array(total);
  const codeOf = neighbourCodes(width);
  /** The last position of each hash, and the previous position with the same hash. */
  const heads = new Int32Array(1 << HASH_BITS).fill(-1);
  const before = new Int32Array(total);
  let hashed = 0;
  let bestLength = 0;
  let bestDistance = 0;

  const hashUpTo = (end: number) => {
    for (; hashed < end; hashed++) {
      if (hashed + 1 >= total) break;
      const hash = hashOf(pixels[hashed], pixels[hashed + 1]);
      before[hashed] = heads[hash];
      heads[hash] = hashed;
    }
  };
  const find = (at: number) => {
    bestLength = 0;
    if (at + LEAST_LENGTH > total) return;
    hashUpTo(at);
    const most = Math.min(MOST_LENGTH, total - at);
    const consider = (from: number) => {
      if (bestLength > 0 && pixels[from + bestLength] !== pixels[at + bestLength]) return;
      let length = 0;
      while (length < most && pixels[from + length] === pixels[at + length]) length++;
      if (length > bestLength) [bestLength, bestDistance] = [length, at - from];
    };
    if (at > 0) consider(at - 1);
    if (at >= width) consider(at - width);
    let from = heads[hashOf(pixels[at], pixels[at + 1])];
    for (
      let tries = 0;
      from >= 0 && tries < MOST_TRIES && bestLength < Math.min(most, LONG_ENOUGH);
      tries++
    ) {
      if (at - from > MOST_DISTANCE) break;
      consider(from);
      from = before[from];
    }
    if (bestLength < LEAST_LENGTH) bestLength = 0;
  };

  let count = 0;
  let nextPause = PIXELS_AT_ONCE;
  for (let at = 0; at < total; ) {
    if (at >= nextPause) {
      nextPause = at + PIXELS_AT_ONCE;
      await turns.give();
    }
    find(at);
    const distance = bestDistance;
    let length = bestLength;
    const isWorth = length * pixelBits >= copyBits(length, distance);
    if (isWorth && length < LONG_ENOUGH) {
      // Lazy matching: a longer copy may begin at the next pixel.
      find(at + 1);
      if (bestLength > length + 1) length = 0;
    }
    if (isWorth && length > 0) {
      lengths[count] = length;
      distanceCodes[count++] = codeOf.get(distance) ?? distance + NEIGHBOURS.length;
      at += length;
    } else {
      const singles = Math.max(1, length);
      lengths.fill(1, count, count + singles);
      count += singles;
      at += singles;
    }
  }
  return { count, lengths, distanceCodes };
}

/** Estimated bits of a copy: its symbols and their extra bits. */
function copyBits(length: number, distance: number): number {
  return length === 0 ? Number.POSITIVE_INFINITY : 10 + Math.log2(length) + Math.log2(distance);
}

function hashOf(first: number, second: number): number {
  return (Math.imul(first, 0x9e3779b1) + Math.imul(second, 0x85ebca6b)) >>> (32 - HASH_BITS);
}

/** The short code of each distance that is a neighbour's. */
function neighbourCodes(width: number): ReadonlyMap<number, number> {
  const codes = new Map<number, number>();
  NEIGHBOURS.forEach((neighbour, i) => {
    const distance = distanceTo(neighbour, width);
    if (!codes.has(distance)) codes.set(distance, i + 1);
  });
  return codes;
}
