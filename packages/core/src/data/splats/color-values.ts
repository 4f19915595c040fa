/** The spherical harmonic of degree 0, √(1/4π). */
const SH_C0 = 0.28209479177387814;

/**
 * The coefficient of degree 0 that gives a base colour, where 0 is black and 1 is white.
 *
 * @example
 * const set = await readSplats('/garden.ply');
 * set.colorDc.fill(colorDcOf(0.5)); // the base colour of every splat is grey
 * const cloud = engine.add(set);
 */
export function colorDcOf(color: number): number {
  return (color - 0.5) / SH_C0;
}

/**
 * The base colour of a coefficient of degree 0, where 0 is black and 1 is white; it may lie beyond.
 *
 * @example
 * const { colorDc } = await readSplats('/garden.ply');
 * const [red, green, blue] = [colorOf(colorDc[0]), colorOf(colorDc[1]), colorOf(colorDc[2])];
 */
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

/** Logit of the opacity σ(`logit`) · e^`logShare`, a share of at most 1. */
export function logitOfShare(logit: number, logShare: number): number {
  // log σ(x), without overflow of the exponential.
  const logOpacity = Math.min(0, logit) - Math.log1p(Math.exp(-Math.abs(logit)));
  const logFused = logOpacity + logShare;
  return logFused - Math.log(-Math.expm1(logFused));
}

/** The values of all bytes, where 255 stands for 1. */
export function tableOfBytes(convert: (value: number) => number): Float32Array {
  return Float32Array.from({ length: 256 }, (_, byte) => convert(byte / 255));
}
