import type { LogScaleRange } from './geometry.ts';
import { LOG_SCALE_LIMIT } from './log-scale.ts';

/**
 * The range with which ingest-rows packs, before that of the cloud is known: a step is 2⁻⁹, and stands for its middle.
 */
export const INGEST_LOG_SCALES: LogScaleRange = { min: -LOG_SCALE_LIMIT + 2 ** -10, step: 2 ** -9 };

/** A clamped log scale in steps of 2⁻¹⁹ above −40, as ingest-rows keeps it. */
export function ingestLogScaleSteps(logScale: number): number {
  const whole = Math.floor(logScale);
  return (whole + LOG_SCALE_LIMIT) * 2 ** 19 + Math.floor((logScale - whole) * 2 ** 19 + 0.5);
}
