import type { AccuracySettings } from '@websplatter/core';

/** Content of one side of a split image: `current` follows the chosen accuracy. */
export type ComparisonSide = 'current' | AccuracySettings;

/** Two accuracies of the same view, shown at once. */
export type Comparison =
  /** Side by side, divided by a line that can be moved. */
  | { readonly kind: 'split'; readonly left: ComparisonSide; readonly right: ComparisonSide }
  /** The error of each pixel: how far the shown accuracy is from `reference`. */
  | { readonly kind: 'error' };

/** @param current the chosen settings, or the target. */
export function sideAccuracy<T>(side: ComparisonSide, current: T): AccuracySettings | T {
  return side === 'current' ? current : side;
}
