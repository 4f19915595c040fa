import type { AccuracySettings } from '@websplatter/core';
import type { AccuracyTable, EffectCost, MeasureProgress } from '@websplatter/core/measure';
import type { LayerImage } from './frames.ts';

/** Subject of a measurement. */
export type MeasuredThing = 'accuracy' | 'effects';

/** A measurement under way, and how far it has come. */
export interface RunningMeasurement extends MeasureProgress {
  readonly of: MeasuredThing;
}

/** Why a measurement came to nothing. */
export interface FailedMeasurement {
  readonly of: MeasuredThing;
  readonly text: string;
}

/** The measured image, and its kind of device. */
export interface MeasuredImage {
  /** The result is stale when another image is on the screen. */
  readonly imageId: number;
  readonly isSoftware: boolean;
}

/** Extent of a measurement of accuracy: the presets, every setting, or as a target needs. */
export type AccuracySweep = 'presets' | 'settings' | 'target';

/** Measured costs of accuracy. */
export interface MeasuredAccuracy extends MeasuredImage {
  readonly table: AccuracyTable;
  readonly sweep: AccuracySweep;
  /** Whether it was cancelled before all of it was measured. */
  readonly isCutShort: boolean;
  /** Estimated time to measure every setting, ms; null unless the presets were measured alone. */
  readonly allSettingsMs: number | null;
}

/** A picture, and the part of it that is farthest from the reference. */
export interface JudgedPicture {
  readonly whole: LayerImage;
  /** Top left of the crops in the picture. */
  readonly xPx: number;
  readonly yPx: number;
  /** Fractions of pixels that are off by more than 1 and by more than 8 of 255, rounded. */
  readonly beyond1: number;
  readonly beyond8: number;
  readonly actual: LayerImage;
  readonly reference: LayerImage;
  /** In the colours of an error map. */
  readonly error: LayerImage;
}

/** Pictures of measured presets, by name. */
export type JudgedPictures = Readonly<Record<string, JudgedPicture>>;

/** Measured costs of effects. */
export interface MeasuredEffects extends MeasuredImage {
  readonly costs: readonly EffectCost[];
  /** Accuracy of the measured frames; the costs are stale under another one. */
  readonly accuracy: AccuracySettings;
}

export interface MeasuredState {
  readonly measuring: RunningMeasurement | null;
  /** The failure of the last measurement, if it failed. */
  readonly failedMeasurement: FailedMeasurement | null;
  readonly measured: MeasuredAccuracy | null;
  /** Pictures of the measured presets that have been drawn; null for another image. */
  readonly judged: JudgedPictures | null;
  /** The measured preset whose picture is shown while the pointer is on its row. */
  readonly looked: string | null;
  readonly effectCosts: MeasuredEffects | null;
}

export const FIRST_MEASURED: MeasuredState = {
  measuring: null,
  failedMeasurement: null,
  measured: null,
  judged: null,
  looked: null,
  effectCosts: null,
};
