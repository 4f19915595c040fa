const f32 = new Float32Array(1);
const u32 = new Uint32Array(f32.buffer);

/**
 * Returns the bits of the float32 nearest to `depthView`, as an unsigned integer in the order of
 * the numbers: a < b exactly if orderedBits(a) < orderedBits(b). −0 counts as 0. Reference of
 * shaders/lib/depth-key.wgsl.
 */
export function orderedBits(depthView: number): number {
  f32[0] = depthView + 0;
  return (u32[0] & 0x80000000 ? ~u32[0] : u32[0] | 0x80000000) >>> 0;
}

/** Beyond it, squares would leave float32's range. */
const MOST_UNITS = 1e19;

/**
 * Key of splats that are sorted by distance: its square, in units of the power of two below `near`,
 * or of 1 for a near of 0. Reference of `sortDepth` in shaders/lib/depth-key.wgsl.
 */
export function sortDistance(distance: number, near: number): number {
  f32[0] = near;
  const exponent = (u32[0] >>> 23) & 0xff;
  const units = Math.min(distance * 2 ** (exponent === 0 ? 0 : 127 - exponent), MOST_UNITS);
  return units * units;
}

/** Returns the sort key: far first, 0 for the farthest visible splat and for anything beyond it. */
export function depthKey(depthView: number, farthestBits: number): number {
  return farthestBits - Math.min(farthestBits, orderedBits(depthView));
}

/** Returns the top `keyBits` bits of `depthKey` clamped to the range of visible depths. */
export function shortDepthKey(
  depthView: number,
  farthestBits: number,
  nearestBits: number,
  keyBits: number,
): number {
  const range = farthestBits - nearestBits;
  const rangeBits = 32 - Math.clz32(range);
  return Math.min(range, depthKey(depthView, farthestBits)) >>> Math.max(0, rangeBits - keyBits);
}

/** The two words of a wide sort key, or of a float64. */
export interface WideKey {
  readonly low: number;
  readonly high: number;
}

const f64 = new Float64Array(1);
const halves = new Uint32Array(f64.buffer);

/**
 * Maps a float64 to two unsigned words that compare like the numbers, upper word first: the words of
 * a are less than the words of b exactly if a < b. −0 counts as 0.
 */
export function orderedWords(value: number): WideKey {
  f64[0] = value + 0;
  const [low, high] = halves;
  return high & 0x80000000
    ? { low: ~low >>> 0, high: ~high >>> 0 }
    : { low, high: (high | 0x80000000) >>> 0 };
}

/**
 * Returns the wide sort key of a float64 depth, or of the square of a distance: far first.
 *
 * @param farthestHigh `orderedWords(…).high` of a depth that no splat of the frame lies beyond.
 */
export function wideKey(depthView: number, farthestHigh: number): WideKey {
  const { low, high } = orderedWords(depthView);
  return { low: ~low >>> 0, high: farthestHigh - Math.min(farthestHigh, high) };
}
