/** The sRGB transfer function (IEC 61966-2-1), continued above 1 and, as an odd one, below 0. */
export function encodeSrgb(linear: number): number {
  const size = Math.abs(linear);
  return Math.sign(linear) * (size <= 0.0031308 ? 12.92 * size : 1.055 * size ** (1 / 2.4) - 0.055);
}

/** Inverse of `encodeSrgb`. */
export function decodeSrgb(encoded: number): number {
  const size = Math.abs(encoded);
  return Math.sign(encoded) * (size <= 0.04045 ? size / 12.92 : ((size + 0.055) / 1.055) ** 2.4);
}
