/** The spherical harmonic of degree 0, √(1/4π). */
const SH_C0 = 0.28209479177387814;

/** The coefficient of degree 0 that gives a base colour, where 0 is black and 1 is white. */
export function colorDcOf(color: number): number {
  return (color - 0.5) / SH_C0;
}

/** The base colour of a coefficient of degree 0, where 0 is black and 1 is white; it may lie beyond. */
export function colorOf(colorDc: number): number {
  return colorDc * SH_C0 + 0.5;
}

/** ±Infinity for opacities of 1 and 0. */
export function logitOf(opacity: number): number {
  return Math.log(opacity / (1 - opacity));
}

/** Peak opacity, 0…1, of a logit; ±Infinity allowed. */
export function opacityOf(logit: number): number {
  return 1 / (1 + Math.exp(-logit));
}

/** The values of all bytes, where 255 stands for 1. */
export function tableOfBytes(convert: (value: number) => number): Float32Array {
  return Float32Array.from({ length: 256 }, (_, byte) => convert(byte / 255));
}
