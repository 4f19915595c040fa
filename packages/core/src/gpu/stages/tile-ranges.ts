import type { StageDefinition } from '../pipelines.ts';
import { tileSource } from '../shaders/later-source.ts';

/** Finds each bin's pairs, and the order of the bins. */
export const tileRanges: StageDefinition = {
  stage: 'tile-ranges',
  source: tileSource('tile-ranges'),
  entryPoint: 'tileRanges',
};
