import type { RecordPrecision } from '../accuracy/accuracy.ts';

/** Conditions of linking for shaders that write or read records. */
export function recordConditions(precision: RecordPrecision) {
  return { RECORD_F32: precision === 'f32', RECORD_PAPER: precision === 'paper' };
}
