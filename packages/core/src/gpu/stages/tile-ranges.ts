import type { StageDefinition } from '../pipelines.ts';
import { tileSource } from '../shaders/later-source.ts';

/** Finds each bin's pairs, and the order of the bins. */
export const tileRanges = {
  stage: 'tile-ranges',
  source: tileSource('tile-ranges'),
  entryPoint: 'tileRanges',
  bindings: {
    grid: [0, 'uniform'],
    tilePlan: [1, 'read'],
    sortedBins: [2, 'read'],
    binStarts: [3, 'read-write'],
    binOrder: [4, 'read-write'],
  },
} as const satisfies StageDefinition;
