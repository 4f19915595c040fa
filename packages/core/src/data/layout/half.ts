const f32 = new Float32Array(1);
const u32 = new Uint32Array(f32.buffer);

/**
 * Largest colour coefficient that is stored as float32: a file may hold up to 3e38, and the sum of
 * sixteen such terms would leave float32's range.
 */
export const COEFFICIENT_MAX = 1e35;

export function clampCoefficient(value: number): number {
  return Math.max(-COEFFICIENT_MAX, Math.min(COEFFICIENT_MAX, value));
}

/** Largest finite binary16 value. */
export const HALF_MAX = 65504;

/**
 * Returns the bits of the binary16 nearest to `value`, ties to even; beyond ±65504 the bits of
 * ±65504, so that packing never produces an infinity. `value` is finite.
 */
export function toHalfBits(value: number): number {
  f32[0] = Math.max(-HALF_MAX, Math.min(HALF_MAX, value));
  const bits = u32[0];
  const sign = (bits >>> 16) & 0x8000;
  const magnitude = bits & 0x7fffffff;
  if (magnitude < 0x38800000) {
    // Below 2^-14 binary16 has multiples of 2^-24: adding 0.5 to a float32 rounds to that grid.
    f32[0] = Math.abs(f32[0]) + 0.5;
    return sign | (u32[0] - 0x3f000000);
  }
  const roundedToEven = magnitude + 0xfff + ((magnitude >>> 13) & 1);
  return sign | ((roundedToEven - 0x38000000) >>> 13);
}

/** Returns the value of binary16 bits. */
export function fromHalfBits(bits: number): number {
  const exponent = (bits >>> 10) & 0x1f;
  const mantissa = bits & 0x3ff;
  const sign = bits & 0x8000;
  if (exponent === 0) return (sign ? -1 : 1) * mantissa * 2 ** -24;
  const wideExponent = exponent === 31 ? 255 : exponent + 112;
  // By the bits of the float32 of the same value: powers of two would take half of the time of packing.
  u32[0] = (sign << 16) | (wideExponent << 23) | (mantissa << 13);
  return f32[0];
}
