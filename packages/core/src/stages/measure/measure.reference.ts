import type { SizePx } from '../../data/accuracy/accuracy.ts';

/**
 * Reference of average-samples: each pixel of an image is the mean of a square of samples.
 *
 * @param samples RGBA, top row first, `perSide` times as many as pixels along each side.
 * @param size of the image.
 */
export function averageSamples(
  samples: ArrayLike<number>,
  { widthPx, heightPx }: SizePx,
  perSide: number,
): Float64Array {
  return Float64Array.from({ length: 4 * widthPx * heightPx }, (_, i) => {
    const [x, y] = [(i >> 2) % widthPx, Math.floor((i >> 2) / widthPx)];
    let sum = 0;
    for (let row = perSide * y; row < perSide * (y + 1); row++)
      for (let column = perSide * x; column < perSide * (x + 1); column++)
        sum += samples[4 * (row * perSide * widthPx + column) + (i & 3)];
    return sum / perSide ** 2;
  });
}

/** Differences between two images. */
export interface ImageDifference {
  /** −10·log10 of the mean squared error over r, g, b; Infinity for equal images. */
  readonly psnrDb: number;
  /** Largest absolute error of any channel, 0…1. */
  readonly maxError: number;
  /** 99.9th percentile of the absolute error; computed when read. */
  readonly p999Error: number;
  /** Mean structural similarity over r, g, b (11×11 Gaussian, σ 1.5), −1…1; computed when read. */
  readonly ssim: number;
}

/** Options of `compareImages`. */
export interface CompareOptions {
  readonly widthPx: number;
  readonly heightPx: number;
  /** Background of both images, 0…1; default black. */
  readonly background?: readonly [number, number, number];
  /** `raw`, the default: not rounded; `png`: rounded to 8 bits. Both clamp to 0…1. */
  readonly quantize?: 'raw' | 'png';
}

/**
 * Compares two images of premultiplied RGBA, 4·width·height values each.
 *
 * @throws RangeError if a length does not fit the size, or a value is not finite: an image that
 *   contains a NaN has no distance to another one.
 */
export function compareImages(
  actual: ArrayLike<number>,
  expected: ArrayLike<number>,
  options: CompareOptions,
): ImageDifference {
  const a = flattened('actual', actual, options);
  const b = flattened('expected', expected, options);
  let sum = 0;
  let maxError = 0;
  for (let i = 0; i < a.length; i++) {
    const error = Math.abs(a[i] - b[i]);
    sum += error * error;
    maxError = Math.max(maxError, error);
  }
  const meanSquaredError = sum / a.length;
  return {
    psnrDb: meanSquaredError === 0 ? Number.POSITIVE_INFINITY : -10 * Math.log10(meanSquaredError),
    maxError,
    // These take more than ten times as long as everything else, and few callers want them.
    get p999Error() {
      const errors = a.map((value, i) => Math.abs(value - b[i])).sort();
      return errors[Math.min(errors.length - 1, Math.floor(0.999 * errors.length))];
    },
    get ssim() {
      return structuralSimilarity(a, b, options.widthPx, options.heightPx);
    },
  };
}

/** Composites the image over the background: r, g, b in 0…1. */
function flattened(name: string, image: ArrayLike<number>, options: CompareOptions): Float64Array {
  const { widthPx, heightPx, background = [0, 0, 0], quantize = 'raw' } = options;
  const pixels = widthPx * heightPx;
  if (image.length !== 4 * pixels) {
    throw new RangeError(
      `${name} has ${image.length} values; ${widthPx}×${heightPx} RGBA has ${4 * pixels}.`,
    );
  }
  const result = new Float64Array(3 * pixels);
  for (let pixel = 0; pixel < pixels; pixel++) {
    for (let channel = 0; channel < 3; channel++) {
      const value = image[4 * pixel + channel] + (1 - image[4 * pixel + 3]) * background[channel];
      if (!Number.isFinite(value))
        throw new RangeError(`${name} is ${value} at pixel ${pixel}, channel ${channel}.`);
      const clamped = Math.max(0, Math.min(1, value));
      result[3 * pixel + channel] = quantize === 'png' ? Math.round(clamped * 255) / 255 : clamped;
    }
  }
  return result;
}

const SSIM_RADIUS = 5;
const SSIM_SIGMA = 1.5;
/** Weights of the window by distance from its middle, px. */
const SSIM_WEIGHTS = Array.from({ length: SSIM_RADIUS + 1 }, (_, px) =>
  Math.exp(-(px ** 2) / (2 * SSIM_SIGMA ** 2)),
);
const SSIM_C1 = 0.01 ** 2;
const SSIM_C2 = 0.03 ** 2;

/** Mean SSIM. Windows are cut off at the border, and their weights renormalised. */
function structuralSimilarity(a: Float64Array, b: Float64Array, widthPx: number, heightPx: number): number {
  const products = a.map((value, i) => value * b[i]);
  const [meanA, meanB, meanAA, meanBB, meanAB] = [
    a,
    b,
    a.map((v) => v * v),
    b.map((v) => v * v),
    products,
  ].map((image) => blurred(image, widthPx, heightPx));
  let sum = 0;
  for (let i = 0; i < a.length; i++) {
    const varianceA = meanAA[i] - meanA[i] * meanA[i];
    const varianceB = meanBB[i] - meanB[i] * meanB[i];
    const covariance = meanAB[i] - meanA[i] * meanB[i];
    sum +=
      ((2 * meanA[i] * meanB[i] + SSIM_C1) * (2 * covariance + SSIM_C2)) /
      ((meanA[i] ** 2 + meanB[i] ** 2 + SSIM_C1) * (varianceA + varianceB + SSIM_C2));
  }
  return sum / a.length;
}

function blurred(image: Float64Array, widthPx: number, heightPx: number): Float64Array {
  const horizontal = blurredAlong(image, widthPx, heightPx, 3, 3 * widthPx);
  return blurredAlong(horizontal, heightPx, widthPx, 3 * widthPx, 3);
}

/** Gaussian blur of `lines` lines, `lineStep` values apart, of `length` pixels, `step` apart. */
function blurredAlong(
  image: Float64Array,
  length: number,
  lines: number,
  step: number,
  lineStep: number,
): Float64Array {
  const result = new Float64Array(image.length);
  for (let line = 0; line < lines; line++) {
    for (let i = 0; i < length; i++) {
      const first = Math.max(0, i - SSIM_RADIUS);
      const last = Math.min(length - 1, i + SSIM_RADIUS);
      let weightSum = 0;
      const sums = [0, 0, 0];
      for (let j = first; j <= last; j++) {
        const weight = SSIM_WEIGHTS[Math.abs(j - i)];
        weightSum += weight;
        for (let channel = 0; channel < 3; channel++)
          sums[channel] += weight * image[line * lineStep + j * step + channel];
      }
      for (let channel = 0; channel < 3; channel++) {
        result[line * lineStep + i * step + channel] = sums[channel] / weightSum;
      }
    }
  }
  return result;
}

/** Reference of copy-words. */
export function copyWords(words: Uint32Array): Uint32Array {
  return words.slice();
}
