import { ACCURACY_PRESETS, type AccuracySettings, type Detail } from '@websplatter/core';
import { isSameAccuracy } from './nearest-preset.ts';

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

/** The side that is compared with `reference`: the drawn one, or `fast` if that is `reference`. */
export function comparedWithReference(drawn: Drawn): Drawn {
  const { reference, fast } = ACCURACY_PRESETS;
  const isReference = drawn.detail === 'full' && isSameAccuracy(drawn.accuracy, reference);
  return isReference ? { accuracy: fast, detail: 'full' } : drawn;
}

/** Figures of an error map. */
export interface ErrorFigures {
  /** Largest difference of a channel, in steps of an 8-bit channel. */
  readonly maxSteps: number;
  /** Part of the pixels in each class of errors, 0…1. */
  readonly parts: readonly number[];
}

export interface ComparisonState {
  readonly comparison: Comparison | null;
  /** Place of a split image's line, 0…1 of its width. */
  readonly splitPart: number;
  /** Error of the image on the screen against `reference`; null unless it is shown and known. */
  readonly errorFigures: ErrorFigures | null;
}

export const FIRST_COMPARISON: ComparisonState = { comparison: null, splitPart: 0.5, errorFigures: null };
