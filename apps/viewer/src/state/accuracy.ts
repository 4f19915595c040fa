import {
  type AccuracyChoice,
  type AccuracySettings,
  type AccuracyTarget,
  type Detail,
  resolveAccuracy,
} from '@websplatter/core';
import type { ComparisonState } from './comparison.ts';

export type AccuracyTab = 'measure' | 'compare' | 'settings';

/** Accuracy and detail of frames. */
export interface AccuracyState {
  readonly accuracyTab: AccuracyTab;
  /** Settings that frames are drawn with: asked for, or chosen for the target. */
  readonly accuracy: AccuracySettings;
  /** Settings that this device begins with; the page's address leaves them out. */
  readonly defaultAccuracy: AccuracySettings;
  /** The outcome to keep in every scene; null if a person chose the settings. */
  readonly target: AccuracyTarget | null;
  /** The settings chosen for the target, and why; null until this scene has been measured. */
  readonly choice: AccuracyChoice | null;
  /** Settings that the GPU cannot honour, in words. */
  readonly accuracyNotices: readonly string[];
  /** How many splats are asked for; all by default. */
  readonly detail: Detail;
  /** Whether a person or the address asked for that detail. */
  readonly isDetailChosen: boolean;
  /** Time of a frame of all splats if this device is slow to draw it, ms; else null. */
  readonly wholeFrameMs: number | null;
}

const DEFAULT_SETTINGS = resolveAccuracy();

export const FIRST_ACCURACY: AccuracyState = {
  accuracyTab: 'measure',
  accuracy: DEFAULT_SETTINGS,
  defaultAccuracy: DEFAULT_SETTINGS,
  target: null,
  choice: null,
  accuracyNotices: [],
  detail: 'full',
  isDetailChosen: false,
  wholeFrameMs: null,
};

/** On slow devices: 20 frames a second show more of the scene than 60, which `auto` aims at. */
const COARSER_IN_MOTION: Detail = { maxFrameMs: 50 };

/**
 * The detail of frames. Unless a person chose one, slow devices draw fewer splats while something
 * moves; a split image keeps all of them, since its sides must differ in accuracy alone.
 */
export function detailOfFrames({
  detail,
  isDetailChosen,
  wholeFrameMs,
  comparison,
}: Pick<
  AccuracyState & ComparisonState,
  'detail' | 'isDetailChosen' | 'wholeFrameMs' | 'comparison'
>): Detail {
  const isCoarser = !isDetailChosen && wholeFrameMs !== null && comparison?.kind !== 'split';
  return isCoarser ? COARSER_IN_MOTION : detail;
}
