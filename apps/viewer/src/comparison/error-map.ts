import type { Vec3 } from '@websplatter/core';
import type { LayerImage } from '../drawing/draw-at-rest.ts';
import type { ImageOnBackground } from '../drawing/drawn-frame.ts';
import type { ErrorFigures } from '../state/viewer-state.ts';

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
  const data = new Uint8ClampedArray(actual.data.length);
  const counts = ERROR_CLASSES.map(() => 0);
  let maxSteps = 0;
  for (let at = 0; at < data.length; at += 4) {
    let steps = 0;
    for (let channel = 0; channel < 3; channel++) {
      const difference =
        shown(actual.data, at, channel, background) - shown(reference.data, at, channel, background);
      steps = Math.max(steps, 255 * Math.abs(difference));
    }
    maxSteps = Math.max(maxSteps, steps);
    const index = classOf(steps);
    counts[index]++;
    data.set(ERROR_CLASSES[index].color, at);
    data[at + 3] = 255;
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

/** A channel of the pixel at `at` as the screen shows it, 0…1. */
function shown(data: Float32Array, at: number, channel: number, background: Vec3): number {
  return Math.min(1, Math.max(0, data[at + channel] + (1 - data[at + 3]) * background[channel]));
}
