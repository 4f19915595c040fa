import type { FrameContributions, FrameCosts } from '@websplatter/core/inspect';
import type { LayerImage } from '../state/frames.ts';
import type { Vec3 } from '../state/vec3.ts';
import { logPart } from './map-scales.ts';
import { type Ramp, UNSEEN_COLOR, VALUE_RAMP } from './ramp.ts';

/** Fraction of their own colour that pixels near an unseen splat keep. */
const BESIDE_UNSEEN = 0.25;
/** Brightness of colours on the lines between tiles. */
const LINE_LIGHT = 0.7;
/**
 * Fraction of the highest values that lies beyond the end of the scale: otherwise a few hot spots
 * would take most of it.
 */
const BEYOND_SCALE = 0.01;

/** Numbers of tiles or pixels for a legend. */
export interface CountFigures {
  readonly max: number;
  readonly mean: number;
  /** End of the scale: four times a number with few digits, at least 1. */
  readonly end: number;
}

export function countFigures(counts: Uint32Array): CountFigures {
  let [max, sum] = [0, 0];
  for (const count of counts) {
    if (count > max) max = count;
    sum += count;
  }
  const numberOf = new Uint32Array(max + 1);
  for (const count of counts) numberOf[count]++;
  let [end, above] = [max, 0];
  while (end > 0 && above + numberOf[end] <= BEYOND_SCALE * counts.length) above += numberOf[end--];
  return { max, mean: sum / Math.max(1, counts.length), end: scaleEnd(end) };
}

/** The next number whose quarters have few digits. */
function scaleEnd(value: number): number {
  const quarter = Math.max(1, value / 4);
  const power = 10 ** Math.floor(Math.log10(quarter));
  const step = power >= 100 ? power / 4 : Math.ceil(power / 2);
  return 4 * step * Math.ceil(quarter / step);
}

/** Image of the tile lists' lengths, with lines between tiles. */
export function tileImage(
  { widthPx, heightPx, tilePx, tileColumns, tileEntries }: FrameCosts,
  end: number,
): LayerImage {
  return paint(widthPx, heightPx, (at, write) => {
    const [x, y] = [at % widthPx, Math.floor(at / widthPx)];
    const entries = tileEntries[Math.floor(y / tilePx) * tileColumns + Math.floor(x / tilePx)];
    const isLine = x % tilePx === 0 || y % tilePx === 0;
    write(VALUE_RAMP, entries / end, isLine ? LINE_LIGHT : 1);
  });
}

/** @param counts per pixel, row by row. */
export function pixelImage({ widthPx, heightPx }: FrameCosts, counts: Uint32Array, end: number): LayerImage {
  return paint(widthPx, heightPx, (at, write) => write(VALUE_RAMP, counts[at] / end));
}

/**
 * Image of contributions. Splats are blended as in the picture, coloured by their contribution.
 * Pixels with unseen splats are then marked, more strongly the more there are.
 *
 * @param background sRGB, 0…1.
 */
export function contributionImage(
  { widthPx, heightPx, meanLog2, opacity, unseen }: FrameContributions,
  background: Vec3,
): LayerImage {
  const image = paint(widthPx, heightPx, (at, write) => write(VALUE_RAMP, logPart(meanLog2[at])));
  const { data } = image;
  for (let at = 0; at < opacity.length; at++) {
    const kept = BESIDE_UNSEEN ** unseenAround(unseen, at, widthPx);
    for (let c = 0; c < 3; c++) {
      const own = opacity[at] * data[4 * at + c] + (1 - opacity[at]) * 255 * background[c];
      data[4 * at + c] = kept * own + (1 - kept) * UNSEEN_COLOR.color[c];
    }
  }
  return image;
}

/** Unseen splats in a pixel and its four neighbours: a mark of one pixel would be overlooked. */
function unseenAround(unseen: Uint32Array, at: number, widthPx: number): number {
  const x = at % widthPx;
  const left = x > 0 ? unseen[at - 1] : 0;
  const right = x + 1 < widthPx ? unseen[at + 1] : 0;
  return unseen[at] + left + right + (unseen[at - widthPx] ?? 0) + (unseen[at + widthPx] ?? 0);
}

/** Writes the colour at a position 0…1 on a ramp; `light` darkens it. */
type WritePixel = (ramp: Ramp, part: number, light?: number) => void;

function paint(widthPx: number, heightPx: number, draw: (at: number, write: WritePixel) => void): LayerImage {
  const data = new Uint8ClampedArray(4 * widthPx * heightPx);
  let at = 0;
  const write: WritePixel = ({ low, high }, part, light = 1) => {
    const share = Math.min(1, Math.max(0, part));
    for (let c = 0; c < 3; c++)
      data[4 * at + c] = light * (low.color[c] + share * (high.color[c] - low.color[c]));
    data[4 * at + 3] = 255;
  };
  for (; at < widthPx * heightPx; at++) draw(at, write);
  return { widthPx, heightPx, data };
}
