import type { Turns } from '../../data/turns.ts';
import { average, blocks, clampedHalf, clampedSum, select } from './vp8l-format.ts';

/** Log2 of the side of a predictor block, in pixels. */
export const PREDICTOR_BITS = 4;
const MODES = 14;
const BLACK = 0xff000000 | 0;

/** An image as residuals of its predictors. */
export interface Predicted {
  /** Predictor of each block, in the green channel. */
  readonly modes: Int32Array;
  readonly rest: Int32Array;
}

/** Subtracts green from red and blue (section 3.5.3). */
export function withoutGreen(pixels: Int32Array): Int32Array {
  return pixels.map((argb) => {
    const green = (argb >>> 8) & 255;
    return (argb & 0xff00ff00) | ((0xff00ff00 + (argb & 0x00ff00ff) - ((green << 16) | green)) & 0x00ff00ff);
  });
}

/**
 * Chooses the cheapest predictor (section 3.5.1) for each block. The cost of its residuals is
 * estimated from the residuals of earlier blocks.
 */
export async function predict(pixels: Int32Array, width: number, turns: Turns): Promise<Predicted> {
  const height = pixels.length / width;
  const perRow = blocks(width, PREDICTOR_BITS);
  const modes = new Int32Array(perRow * blocks(height, PREDICTOR_BITS));
  const rest = new Int32Array(pixels.length);
  const side = 1 << PREDICTOR_BITS;
  /** Residuals of a block for each predictor. */
  const rests = new Int32Array(MODES * side * side);
  const costs = new RestCosts();
  for (let block = 0; block < modes.length; block++) {
    const left = (block % perRow) * side;
    const top = Math.floor(block / perRow) * side;
    const right = Math.min(width, left + side);
    const bottom = Math.min(height, top + side);
    const count = (right - left) * (bottom - top);
    let best = 0;
    let least = Number.POSITIVE_INFINITY;
    for (let mode = 0; mode < MODES; mode++) {
      let cost = 0;
      let to = mode * side * side;
      for (let y = top; y < bottom; y++) {
        for (let x = left; x < right; x++) {
          const i = y * width + x;
          const value = lessPixel(pixels[i], prediction(mode, pixels, i, x, y, width));
          rests[to++] = value;
          cost += costs.of(value);
        }
        if (cost >= least) break;
      }
      if (cost < least) [best, least] = [mode, cost];
    }
    modes[block] = BLACK | (best << 8);
    let from = best * side * side;
    costs.add(rests, from, count);
    for (let y = top; y < bottom; y++) for (let x = left; x < right; x++) rest[y * width + x] = rests[from++];
    if (block % 8 === 0) await turns.give();
  }
  return { modes, rest };
}

/** Estimated bits of each residual byte, by its frequency so far. */
class RestCosts {
  readonly #counts = new Float64Array(4 * 256);
  readonly #bits = new Float64Array(4 * 256);
  #added = 0;

  constructor() {
    // Initially, small residuals are assumed to be likely.
    for (let i = 0; i < this.#counts.length; i++) {
      const byte = i & 255;
      this.#counts[i] = 64 * 0.8 ** Math.min(byte, 256 - byte) + 0.5;
    }
    this.#update();
  }

  of(rest: number): number {
    const bits = this.#bits;
    return (
      bits[rest & 255] +
      bits[256 + ((rest >>> 8) & 255)] +
      bits[512 + ((rest >>> 16) & 255)] +
      bits[768 + (rest >>> 24)]
    );
  }

  add(rests: Int32Array, from: number, count: number): void {
    for (let i = from; i < from + count; i++) {
      const rest = rests[i];
      this.#counts[rest & 255]++;
      this.#counts[256 + ((rest >>> 8) & 255)]++;
      this.#counts[512 + ((rest >>> 16) & 255)]++;
      this.#counts[768 + (rest >>> 24)]++;
    }
    this.#added++;
    // At growing intervals, because later residuals change the estimate less.
    if ((this.#added & (this.#added - 1)) === 0 || this.#added % 64 === 0) this.#update();
  }

  #update(): void {
    for (let channel = 0; channel < 4; channel++) {
      let total = 0;
      for (let i = 256 * channel; i < 256 * (channel + 1); i++) total += this.#counts[i];
      for (let i = 256 * channel; i < 256 * (channel + 1); i++)
        this.#bits[i] = Math.log2(total / this.#counts[i]);
    }
  }
}

/** The predicted value of a pixel, from earlier pixels. */
function prediction(
  mode: number,
  pixels: Int32Array,
  i: number,
  x: number,
  y: number,
  width: number,
): number {
  if (y === 0) return x === 0 ? BLACK : pixels[i - 1];
  const top = pixels[i - width];
  if (x === 0) return top;
  const left = pixels[i - 1];
  const topLeft = pixels[i - width - 1];
  // In the last column, this is the first pixel of the current row, as the format requires.
  const topRight = pixels[i - width + 1];
  switch (mode) {
    case 1:
      return left;
    case 2:
      return top;
    case 3:
      return topRight;
    case 4:
      return topLeft;
    case 5:
      return average(average(left, topRight), top);
    case 6:
      return average(left, topLeft);
    case 7:
      return average(left, top);
    case 8:
      return average(topLeft, top);
    case 9:
      return average(top, topRight);
    case 10:
      return average(average(left, topLeft), average(top, topRight));
    case 11:
      return select(left, top, topLeft);
    case 12:
      return clampedSum(left, top, topLeft);
    case 13:
      return clampedHalf(average(left, top), topLeft);
    default:
      return BLACK;
  }
}

/** Subtracts each channel modulo 256: the gaps between channels take the borrow. */
function lessPixel(a: number, b: number): number {
  return (
    ((0x00ff00ff + (a & 0xff00ff00) - (b & 0xff00ff00)) & 0xff00ff00) |
    ((0xff00ff00 + (a & 0x00ff00ff) - (b & 0x00ff00ff)) & 0x00ff00ff)
  );
}
