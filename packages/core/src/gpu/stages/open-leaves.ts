import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import type { StageDefinition } from '../pipelines.ts';
import { levelSource } from '../shaders/later-source.ts';

/** Tells the leaves of a cell whether the cells below them are on the GPU. */
export const openLeaves: StageDefinition = {
  stage: 'open-leaves',
  source: levelSource('open-leaves'),
  entryPoint: 'openLeaves',
  constants: LEVEL_CONSTANTS,
};
