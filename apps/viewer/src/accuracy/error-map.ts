import type { Vec3 } from '@websplatter/core';
import type { ImageOnBackground } from '../engine/drawn-frame.ts';
import { stepsBetween } from '../engine/shown-pixels.ts';
import type { ErrorFigures } from '../state/comparison.ts';
import type { LayerImage } from '../state/frames.ts';

/** A class of errors, from `fromSteps` up to the next class. */
export interface ErrorClass {
  /** In steps of an 8-bit channel. */
  readonly fromSteps: number;
  readonly label: string;
  /** sRGB, 0…255. */
  readonly color: Vec3;
}

/**
 * From black to pale yellow, the lightness rises in about equal steps, so that people who see few
 * hues or none can see the order of the classes. A test holds the lightness.
 */
export const ERROR_CLASSES: readonly ErrorClass[] = [
  { fromSteps: 0, label: '0', color: [10, 8, 24] },
  { fromSteps: 0.5, label: '1', color: [62, 26, 122] },
  { fromSteps: 1.5, label: '2', color: [142, 40, 130] },
  { fromSteps: 3, label: '4', color: [222, 73, 98] },
  { fromSteps: 6, label: '8', color: [252, 151, 96] },
  { fromSteps: 12, label: '16+', color: [252, 246, 184] },
];

/** An image of errors, and its figures. */
export interface ErrorMap extends LayerImage {
  readonly figures: ErrorFigures;
}

/**
 * Classifies each pixel by the largest difference of its channels. Both images have the same size
 * and are put on the first one's background.
 */
export function errorMap(
  { image: actual, background }: ImageOnBackground,
  { image: reference }: ImageOnBackground,
): ErrorMap {
  const { widthPx, heightPx } = actual;
  const steps = stepsBetween(actual.data, reference.data, background);
  const counts = ERROR_CLASSES.map(() => 0);
  for (const each of steps) counts[classOf(each)]++;
  const maxSteps = steps.reduce((most, each) => Math.max(most, each), 0);
  const pixels = Math.max(1, widthPx * heightPx);
  const figures = { maxSteps, parts: counts.map((count) => count / pixels) };
  return { widthPx, heightPx, data: errorColors(steps), figures };
}

/** The colours of the classes, RGBA. */
export function errorColors(steps: Float64Array): Uint8ClampedArray<ArrayBuffer> {
  const data = new Uint8ClampedArray(4 * steps.length);
  for (const [pixel, each] of steps.entries()) {
    data.set(ERROR_CLASSES[classOf(each)].color, 4 * pixel);
    data[4 * pixel + 3] = 255;
  }
  return data;
}

/** Index of the class that an error of `steps` belongs to. */
export function classOf(steps: number): number {
  let index = ERROR_CLASSES.length - 1;
  while (steps < ERROR_CLASSES[index].fromSteps) index--;
  return index;
}
