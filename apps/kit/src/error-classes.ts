import type { Vec3 } from '@websplatter/core';

/** A class of errors from `fromSteps` up to the next class. */
interface ErrorClass {
  /** In steps of an 8-bit channel. */
  readonly fromSteps: number;
  readonly label: string;
  /** sRGB, 0…255. */
  readonly color: Vec3;
}

/**
 * From black to pale yellow. Lightness rises in about equal steps, so that people who see few hues
 * can order the classes. A test checks the lightness.
 */
export const ERROR_CLASSES: readonly ErrorClass[] = [
  { fromSteps: 0, label: '0', color: [10, 8, 24] },
  { fromSteps: 0.5, label: '1', color: [62, 26, 122] },
  { fromSteps: 1.5, label: '2', color: [142, 40, 130] },
  { fromSteps: 3, label: '4', color: [222, 73, 98] },
  { fromSteps: 6, label: '8', color: [252, 151, 96] },
  { fromSteps: 12, label: '16+', color: [252, 246, 184] },
];

/** Index of the class that an error of `steps` belongs to. */
export function classOf(steps: number): number {
  let index = ERROR_CLASSES.length - 1;
  while (steps < ERROR_CLASSES[index].fromSteps) index--;
  return index;
}
