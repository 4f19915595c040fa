// Shared by the reader and the writer of lossless WebP images (VP8L, RFC 9649 section 3).
// "Sections" in comments are of that document.

export const SIGNATURE = 0x2f;

export const TRANSFORM = { predictor: 0, crossColor: 1, subtractGreen: 2, colorIndexing: 3 } as const;

export const CODE_LENGTH_ORDER = [17, 18, 0, 1, 2, 3, 4, 5, 16, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];
export const MAX_CODE_LENGTH = 15;
export const LENGTH_CODES = 24;
export const DISTANCE_CODES = 40;
export const MAX_CACHE_BITS = 11;
/** Hash factor of the colour cache; the highest bits of the product are the slot. */
export const CACHE_FACTOR = 0x1e35a7bd;

/** Offsets [x, y] to the left and upwards of the distance codes 1 to 120 (section 3.6.2.2). */
export const NEIGHBOURS = neighboursByDistance();

/** Distance to a neighbour, in pixels in scan order. */
export function distanceTo([x, y]: readonly [number, number], width: number): number {
  return Math.max(1, x + y * width);
}

/** Number of blocks of 2^bits pixels that cover `size` pixels. */
export function blocks(size: number, bits: number): number {
  return (size + (1 << bits) - 1) >> bits;
}

/** Half of each channel's sum, rounded down. */
export function average(a: number, b: number): number {
  return (((a ^ b) & 0xfefefefe) >>> 1) + (a & b);
}

/** The nearer of `left` and `top` to left + top − topLeft. */
export function select(left: number, top: number, topLeft: number): number {
  let toLeft = 0;
  let toTop = 0;
  for (let shift = 0; shift < 32; shift += 8) {
    const corner = (topLeft >>> shift) & 255;
    toLeft += Math.abs(((top >>> shift) & 255) - corner);
    toTop += Math.abs(((left >>> shift) & 255) - corner);
  }
  return toLeft < toTop ? left : top;
}

export function clampedSum(left: number, top: number, topLeft: number): number {
  let result = 0;
  for (let shift = 0; shift < 32; shift += 8) {
    const sum = ((left >>> shift) & 255) + ((top >>> shift) & 255) - ((topLeft >>> shift) & 255);
    result |= clamp(sum) << shift;
  }
  return result;
}

export function clampedHalf(mean: number, topLeft: number): number {
  let result = 0;
  for (let shift = 0; shift < 32; shift += 8) {
    const value = (mean >>> shift) & 255;
    // Rounded towards zero.
    result |= clamp(value + (((value - ((topLeft >>> shift) & 255)) / 2) | 0)) << shift;
  }
  return result;
}

function clamp(value: number): number {
  return value < 0 ? 0 : value > 255 ? 255 : value;
}

/**
 * Neighbours up to 7 rows above, 8 columns to the left and 7 to the right, nearest first. Ties go
 * to the nearer column, then to the left one.
 */
function neighboursByDistance(): readonly (readonly [number, number])[] {
  const neighbours: [number, number][] = [];
  for (let y = 0; y <= 7; y++) for (let x = y === 0 ? 1 : -7; x <= 8; x++) neighbours.push([x, y]);
  const squared = ([x, y]: readonly [number, number]) => x * x + y * y;
  return neighbours.sort((a, b) => squared(a) - squared(b) || Math.abs(a[0]) - Math.abs(b[0]) || b[0] - a[0]);
}
