import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { levelSource } from '../shaders/later-source.ts';

/** Tells the leaves of a cell whether the cells below them are on the GPU. */
export const openLeaves: StageDefinition = /* @__PURE__ */ computeStage('open-leaves', {
  source: levelSource('open-leaves'),
  constants: LEVEL_CONSTANTS,
});
