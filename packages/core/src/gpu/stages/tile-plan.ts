import type { StageDefinition } from '../pipelines.ts';
import { tileSource } from '../shaders/later-source.ts';
import { type SortShape, sortConstants } from './sort-shape.ts';

/** Decides whether the pairs fit, and sizes the stages that follow. */
export function tilePlan(shape: SortShape) {
  return {
    stage: 'tile-plan',
    source: tileSource('tile-plan'),
    entryPoint: 'planTiles',
    constants: sortConstants(shape),
    bindings: {
      grid: [0, 'uniform'],
      visibleCount: [1, 'read'],
      blockPairs: [2, 'read-write'],
      tilePlan: [3, 'read-write'],
      sortPlan: [4, 'read-write'],
      drawArguments: [5, 'read-write'],
    },
  } as const satisfies StageDefinition;
}
