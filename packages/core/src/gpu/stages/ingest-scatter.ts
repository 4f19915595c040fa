import source from '../../../../../shaders/stages/ingest-scatter.wgsl?raw';
import { PACKING_STRUCTS } from '../../data/layout/packing-structs.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';

/** Writes one word of all splats of a page. */
export const ingestScatter: StageDefinition = /* @__PURE__ */ computeStage('ingest-scatter', {
  source,
  structs: PACKING_STRUCTS,
});
