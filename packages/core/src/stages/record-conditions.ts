import type { RecordPrecision } from '../accuracy/accuracy.ts';

/** What shaders that write or read records of projected splats are linked for. */
export function recordConditions(precision: RecordPrecision) {
  return { RECORD_F32: precision === 'f32', RECORD_PAPER: precision === 'paper' };
}
