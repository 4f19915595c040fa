import {
  ACCURACY_PRESETS,
  ACCURACY_SETTINGS,
  type AccuracyChoice,
  type AccuracyPreset,
  type AccuracySettings,
  type AccuracyTarget,
  DEFAULT_ACCURACY,
  type Detail,
  resolveAccuracy,
} from '@websplatter/core';

export type SettingName = keyof AccuracySettings;

export const SETTING_NAMES = Object.keys(ACCURACY_SETTINGS) as readonly SettingName[];
export const PRESET_NAMES = Object.keys(ACCURACY_PRESETS) as readonly AccuracyPreset[];

/** The preset nearest to `settings`, and the settings that differ; the default wins a tie. */
export function nearestPreset(settings: AccuracySettings): {
  readonly preset: AccuracyPreset;
  readonly changed: readonly SettingName[];
} {
  const candidates = PRESET_NAMES.map((preset) => ({
    preset,
    changed: SETTING_NAMES.filter((name) => settings[name] !== ACCURACY_PRESETS[preset][name]),
  }));
  const fewest = Math.min(...candidates.map(({ changed }) => changed.length));
  const best = candidates.filter(({ changed }) => changed.length === fewest);
  return best.find(({ preset }) => preset === DEFAULT_ACCURACY) ?? best[0];
}

export function isSameAccuracy(a: AccuracySettings, b: AccuracySettings): boolean {
  return SETTING_NAMES.every((name) => a[name] === b[name]);
}

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
