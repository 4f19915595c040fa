import type { ColorTarget, RecordPrecision } from '../data/accuracy/accuracy.ts';

/** Conditions of linking for shaders that write or read records. */
export function recordConditions(precision: RecordPrecision) {
  return { RECORD_F32: precision === 'f32', RECORD_PAPER: precision === 'paper' };
}

/** Conditions of linking for compute shaders that write a layer of colours. */
export function layerConditions(format: ColorTarget) {
  return { LAYER_F32: format === 'rgba32float', LAYER_F16: format === 'rgba16float' };
}
