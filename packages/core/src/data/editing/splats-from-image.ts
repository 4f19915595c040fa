import { InvalidArgumentError, SplatSourceError, WebSplatterError } from '../errors.ts';
import { given, wrongArgument } from '../given.ts';
import { isFiniteF32 } from '../math/float-step.ts';
import { shown } from '../printable.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import { splatsFromArrays } from './splats-from-arrays.ts';

/** Pixels in sRGB, four bytes each: r, g, b and alpha, not premultiplied, top row first; an ImageData. */
export interface ImagePixels {
  readonly width: number;
  readonly height: number;
  readonly data: Uint8ClampedArray | Uint8Array;
  readonly colorSpace?: string;
}

/** An image that `splatsFromImage` takes. */
export type SplatImage = ImagePixels | ImageBitmap | HTMLImageElement | HTMLCanvasElement | OffscreenCanvas;

/** Options of `splatsFromImage`. */
export interface ImageSplatsOptions {
  /** Distance of two pixels' centres, in the scene's units. Default: the image is 1 unit high. */
  readonly pixelSize?: number;
  /**
   * Pixels along each side of the square that one splat stands for, a whole number; default 1. The
   * splat has the square's mean opacity, and its mean colour weighted by opacity.
   */
  readonly stepPx?: number;
  /**
   * Standard deviation of a splat in the image's plane, in parts of the distance between two splats;
   * above 0; default 0.5. Less shows single dots, more closes gaps and blurs edges.
   */
  readonly spread?: number;
}

/** Most splats of an image: enough for one of 3840 × 2160 pixels. */
const MOST_SPLATS = 1 << 23;
/** Thickness of splats, in parts of their standard deviation in the image's plane. */
const THICKNESS = 1e-3;
/** Splats that are less opaque are not drawn. */
const LEAST_OPACITY = 1 / 255;

/**
 * Makes a set of flat splats of an image, one for each pixel, or for each square of `stepPx`. The
 * image is upright in the plane z = 0: its middle is at the origin, x points right, y up, and its
 * front faces +z. From behind it is mirrored; seen from the side, flat splats vanish.
 *
 * Rows follow the pixels from left to right and from top to bottom. Transparent pixels have no splat.
 * Base colours are the pixels' own, opacities are their alpha, and there are no harmonics.
 *
 * @param image ImageData, pixels like it, or an image that a canvas can draw. Images of other origins need
 *   `crossOrigin`, and `await image.decode()`. Canvases premultiply: faint pixels lose digits there.
 * @throws InvalidArgumentError naming the wrong option, or `image` if it has no pixels or too many;
 *   SplatSourceError if its pixels may not be read; WebSplatterError `canvas-unavailable` for all but
 *   pixels where there is no canvas, as in Node.
 * @example
 * const bitmap = await createImageBitmap(file);
 * const cloud = engine.add(splatsFromImage(bitmap, { pixelSize: 2 / bitmap.width })); // 2 units wide
 */
export function splatsFromImage(image: SplatImage, options: ImageSplatsOptions = {}): SplatSet {
  given(options);
  const { width, height, data } = pixelsOf(image);
  const { pixelSize = 1 / height, stepPx = 1, spread = 0.5 } = options;
  checkPositive('pixelSize', pixelSize);
  checkPositive('spread', spread);
  if (!Number.isSafeInteger(stepPx) || stepPx < 1)
    throw wrongArgument('stepPx', stepPx, 'a whole number, 1 or more');
  const columns = Math.ceil(width / stepPx);
  const rows = Math.ceil(height / stepPx);
  if (columns * rows > MOST_SPLATS) {
    const enough = Math.ceil(Math.sqrt((width * height) / MOST_SPLATS));
    const message = `The image has ${columns * rows} splats with stepPx ${stepPx}, and may have ${MOST_SPLATS}: give a stepPx of ${enough} or more.`;
    throw new InvalidArgumentError('image', message);
  }

  const positions = new Float64Array(3 * columns * rows);
  const colors = new Float64Array(3 * columns * rows);
  const opacities = new Float64Array(columns * rows);
  let count = 0;
  for (let row = 0; row < rows; row++)
    for (let column = 0; column < columns; column++) {
      const left = column * stepPx;
      const top = row * stepPx;
      const right = Math.min(left + stepPx, width);
      const bottom = Math.min(top + stepPx, height);
      let alphas = 0;
      const sums = [0, 0, 0];
      for (let y = top; y < bottom; y++)
        for (let x = left; x < right; x++) {
          const at = 4 * (y * width + x);
          alphas += data[at + 3];
          for (let k = 0; k < 3; k++) sums[k] += data[at + 3] * data[at + k];
        }
      const opacity = alphas / (255 * (right - left) * (bottom - top));
      if (opacity < LEAST_OPACITY) continue;
      positions[3 * count] = (left + (stepPx - width) / 2) * pixelSize;
      positions[3 * count + 1] = ((height - stepPx) / 2 - top) * pixelSize;
      for (let k = 0; k < 3; k++) colors[3 * count + k] = sums[k] / (255 * alphas);
      opacities[count++] = opacity;
    }
  const scale = spread * stepPx * pixelSize;
  const scales = new Float64Array(3 * count).fill(scale);
  for (let i = 0; i < count; i++) scales[3 * i + 2] = THICKNESS * scale;
  return splatsFromArrays({
    positions: positions.subarray(0, 3 * count),
    scales,
    opacities: opacities.subarray(0, count),
    colors: colors.subarray(0, 3 * count),
  });
}

/**
 * Returns the context of a new canvas.
 *
 * @param without advice for the message of the error.
 * @throws WebSplatterError `canvas-unavailable` if there is no canvas.
 */
export function drawingContext(
  width: number,
  height: number,
  without: string,
): CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D {
  const canvas =
    'OffscreenCanvas' in globalThis
      ? new OffscreenCanvas(width, height)
      : 'document' in globalThis && Object.assign(document.createElement('canvas'), { width, height });
  const context = canvas && (canvas as OffscreenCanvas).getContext('2d', { willReadFrequently: true });
  if (context) return context;
  throw new WebSplatterError('canvas-unavailable', `There is no canvas here, as in Node: ${without}.`);
}

/** @throws InvalidArgumentError unless `value` is a finite number above 0. */
export function checkPositive(argument: string, value: number): void {
  if (!(isFiniteF32(value) && value > 0)) throw wrongArgument(argument, value, 'a finite number above 0');
}

function pixelsOf(image: SplatImage): ImagePixels {
  const isObject = typeof image === 'object' && image !== null;
  if (isObject && 'data' in image) return checkedPixels(image);
  const width = isObject && ((image as Partial<HTMLImageElement>).naturalWidth ?? image.width);
  const height = isObject && ((image as Partial<HTMLImageElement>).naturalHeight ?? image.height);
  if (!width || !height) {
    const message = `The image is ${shown(image)}, without pixels: give ImageData, or await image.decode() before.`;
    throw new InvalidArgumentError('image', message);
  }
  const context = drawingContext(width, height, 'give the width, height and data of an ImageData');
  try {
    context.drawImage(image as ImageBitmap, 0, 0);
    return context.getImageData(0, 0, width, height, { colorSpace: 'srgb' });
  } catch (cause) {
    const message = `its pixels may not be read (${(cause as Error).message}): one of another origin needs CORS headers, and crossOrigin = 'anonymous'.`;
    throw new SplatSourceError('The image', message, undefined, { cause });
  }
}

function checkedPixels(image: ImagePixels): ImagePixels {
  const { width, height, data, colorSpace = 'srgb' } = image;
  const isWhole = (value: unknown) => Number.isSafeInteger(value) && (value as number) > 0;
  const isFilled = isWhole(width) && isWhole(height) && data?.length === 4 * width * height;
  if (!isFilled || data.BYTES_PER_ELEMENT !== 1) {
    const message = `The image has ${shown(width)} × ${shown(height)} pixels and ${shown(data?.length)} values in data; each pixel needs 4 bytes.`;
    throw new InvalidArgumentError('image', message);
  }
  if (colorSpace === 'srgb') return image;
  const message = `The image's colorSpace is ${shown(colorSpace)}; it must be srgb, as of getImageData(…, { colorSpace: 'srgb' }).`;
  throw new InvalidArgumentError('image', message);
}
