import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import type { StageDefinition } from '../pipelines.ts';
import { levelSource } from '../shaders/later-source.ts';

/** Finds the threshold of each cell of a cloud. */
export const cutCells: StageDefinition = {
  stage: 'cut-cells',
  source: levelSource('cut-cells'),
  entryPoint: 'cutCells',
  constants: LEVEL_CONSTANTS,
};

/** The same, shifted as the frame's budget asks. */
export const shiftCells: StageDefinition = { ...cutCells, conditions: { SHIFTED: true } };
