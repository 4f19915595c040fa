import type { AccuracySettings } from '@websplatter/core';
import type { AccuracyTable, EffectCost, MeasureProgress } from '@websplatter/core/measure';

/** What a measurement is of. */
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

/** Which image was measured, and on what. */
export interface MeasuredImage {
  /** The result is stale when another image is on the screen. */
  readonly imageId: number;
  readonly isSoftware: boolean;
}

/** What is measured of accuracy: the presets, every setting, or what a target needs to know. */
export type AccuracySweep = 'presets' | 'settings' | 'target';

/** What accuracy was measured to cost. */
export interface MeasuredAccuracy extends MeasuredImage {
  readonly table: AccuracyTable;
  readonly sweep: AccuracySweep;
  /** Whether it was called off before all of it was measured. */
  readonly isCutShort: boolean;
  /** How long every setting would take by the times of the presets, ms; null where it was not them that were measured. */
  readonly allSettingsMs: number | null;
}

/** What effects were measured to cost. */
export interface MeasuredEffects extends MeasuredImage {
  readonly costs: readonly EffectCost[];
  /** Accuracy of the measured frames; the costs are stale under another one. */
  readonly accuracy: AccuracySettings;
}
