import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import type { StageDefinition } from '../pipelines.ts';
import { levelSource } from '../shaders/later-source.ts';

/** Counts what cuts through a page would draw, by how far their thresholds are shifted. */
export const cutCount: StageDefinition = {
  stage: 'cut-count',
  source: levelSource('cut-count'),
  entryPoint: 'cutCount',
  constants: LEVEL_CONSTANTS,
};
