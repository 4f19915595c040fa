import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { levelSource } from '../shaders/later-source.ts';

/** Finds the threshold of each cell of a cloud, for each of at most so many instances. */
export function cutCells(batchInstances = 1): StageDefinition {
  return computeStage('cut-cells', {
    source: levelSource('cut-cells'),
    constants: { ...LEVEL_CONSTANTS, BATCH_INSTANCES: batchInstances },
  });
}

/** The same, shifted as the frame's budget asks. */
export function shiftCells(batchInstances = 1): StageDefinition {
  return { ...cutCells(batchInstances), conditions: { SHIFTED: true } };
}
