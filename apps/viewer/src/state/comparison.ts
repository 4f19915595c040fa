import type { AccuracySettings, Detail } from '@websplatter/core';

/** Content of one side of a split image: `current` follows the chosen accuracy. */
export type ComparisonSide = 'current' | AccuracySettings;

/** Two accuracies of the same view, shown at once. */
export type Comparison =
  /** Side by side, divided by a line that can be moved. */
  | { readonly kind: 'split'; readonly left: ComparisonSide; readonly right: ComparisonSide }
  /** The error of each pixel: how far the shown accuracy is from `reference`. */
  | { readonly kind: 'error' };

/** How a picture is drawn. */
export interface Drawn<Accuracy = AccuracySettings> {
  /** Settings, or a target. */
  readonly accuracy: Accuracy;
  readonly detail: Detail;
}

/** How a side is drawn: as `chosen`, or with its own accuracy and all splats, to compare with. */
export function sideDrawn<T>(side: ComparisonSide, chosen: Drawn<T>): Drawn<AccuracySettings | T> {
  return side === 'current' ? chosen : { accuracy: side, detail: 'full' };
}
