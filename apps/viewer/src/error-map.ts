import type { Vec3 } from '@websplatter/core';
import type { PictureOnBackground } from './viewer.ts';

/** A class of errors, from `fromSteps` up to the next class. */
export interface ErrorClass {
  /** In steps of an 8-bit channel. */
  readonly fromSteps: number;
  readonly label: string;
  /** sRGB, 0…255. */
  readonly color: Vec3;
}

/**
 * Colours whose lightness rises by about as much from one to the next, from black to pale yellow: their order can be seen
 * by those who see few hues or none. A test holds the lightness.
 */
export const ERROR_CLASSES: readonly ErrorClass[] = [
  { fromSteps: 0, label: '0', color: [10, 8, 24] },
  { fromSteps: 0.5, label: '1', color: [62, 26, 122] },
  { fromSteps: 1.5, label: '2', color: [142, 40, 130] },
  { fromSteps: 3, label: '4', color: [222, 73, 98] },
  { fromSteps: 6, label: '8', color: [252, 151, 96] },
  { fromSteps: 12, label: '16+', color: [252, 246, 184] },
];

/** A picture of errors, as `ImageData` holds it, and its figures. */
export interface ErrorMap {
  readonly widthPx: number;
  readonly heightPx: number;
  readonly data: Uint8ClampedArray<ArrayBuffer>;
  readonly figures: ErrorFigures;
}

export interface ErrorFigures {
  /** Largest difference of a channel, in steps of an 8-bit channel. */
  readonly maxSteps: number;
  /** Part of the pixels in each of ERROR_CLASSES, 0…1. */
  readonly parts: readonly number[];
}

/** Each pixel's class by the largest difference of its channels, both pictures on the first one's background. */
export function errorMap(actual: PictureOnBackground, reference: PictureOnBackground): ErrorMap {
  const { widthPx, heightPx, background } = actual;
  const data = new Uint8ClampedArray(4 * widthPx * heightPx);
  const counts = ERROR_CLASSES.map(() => 0);
  const actualColor = colorSampler(actual, background);
  const referenceColor = colorSampler(reference, background);
  let maxSteps = 0;
  for (let y = 0; y < heightPx; y++) {
    for (let x = 0; x < widthPx; x++) {
      const a = actualColor(x, y);
      const b = referenceColor(x, y);
      const steps = 255 * Math.max(Math.abs(a[0] - b[0]), Math.abs(a[1] - b[1]), Math.abs(a[2] - b[2]));
      maxSteps = Math.max(maxSteps, steps);
      const index = classOf(steps);
      counts[index]++;
      const { color } = ERROR_CLASSES[index];
      const at = 4 * (y * widthPx + x);
      for (let c = 0; c < 3; c++) data[at + c] = color[c];
      data[at + 3] = 255;
    }
  }
  const pixels = Math.max(1, widthPx * heightPx);
  return { widthPx, heightPx, data, figures: { maxSteps, parts: counts.map((count) => count / pixels) } };
}

/** Index of the class that an error of `steps` belongs to. */
export function classOf(steps: number): number {
  let index = ERROR_CLASSES.length - 1;
  while (steps < ERROR_CLASSES[index].fromSteps) index--;
  return index;
}

/**
 * Tells the colour of the screen's pixel x, y, clamped to what the screen shows, 0…1. A smaller image is filtered as the
 * screen filters it: bilinearly, between the centres of its pixels. What is returned is written over by the next call.
 */
function colorSampler({ image, widthPx, heightPx }: PictureOnBackground, background: Vec3) {
  const { data } = image;
  const color: [number, number, number] = [0, 0, 0];
  const take = (xPx: number, yPx: number, weight: number) => {
    const at = 4 * (yPx * image.widthPx + xPx);
    const through = 1 - data[at + 3];
    for (let c = 0; c < 3; c++) color[c] += weight * (data[at + c] + through * background[c]);
  };
  const isSameSize = image.widthPx === widthPx && image.heightPx === heightPx;
  return (x: number, y: number): Vec3 => {
    color.fill(0);
    if (isSameSize) take(x, y, 1);
    else {
      const [left, right, alongX] = neighbours(x, widthPx, image.widthPx);
      const [top, bottom, alongY] = neighbours(y, heightPx, image.heightPx);
      take(left, top, (1 - alongX) * (1 - alongY));
      take(right, top, alongX * (1 - alongY));
      take(left, bottom, (1 - alongX) * alongY);
      take(right, bottom, alongX * alongY);
    }
    for (let c = 0; c < 3; c++) color[c] = Math.min(1, Math.max(0, color[c]));
    return color;
  };
}

/** The two pixels of `to` between whose centres pixel `at` of `from` has its centre, and how far along. */
function neighbours(at: number, from: number, to: number): [number, number, number] {
  const place = ((at + 0.5) * to) / from - 0.5;
  const first = Math.floor(place);
  const clamp = (index: number) => Math.min(to - 1, Math.max(0, index));
  return [clamp(first), clamp(first + 1), place - first];
}
