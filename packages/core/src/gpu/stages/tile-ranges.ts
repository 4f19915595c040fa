import { computeStage, type StageDefinition } from '../pipelines.ts';
import { tileSource } from '../shaders/later-source.ts';

/** Finds each bin's pairs, and the order of the bins. */
export const tileRanges: StageDefinition = /* @__PURE__ */ computeStage('tile-ranges', {
  source: tileSource('tile-ranges'),
});
