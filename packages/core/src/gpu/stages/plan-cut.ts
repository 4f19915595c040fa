import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { levelSource } from '../shaders/later-source.ts';

/** Finds the least shift of a frame's thresholds that keeps its budget. */
export const planCut: StageDefinition = /* @__PURE__ */ computeStage('plan-cut', {
  source: levelSource('plan-cut'),
  constants: LEVEL_CONSTANTS,
});

/** Returns an error of thresholds, a length, after they were shifted; right to 2 %. */
export function shiftedError(error: number, shift: number): number {
  // Codes are of squares, sixteen to the octave.
  return error * 2 ** ((shift - LEVEL_CONSTANTS.SHIFT_NONE) / 32);
}
