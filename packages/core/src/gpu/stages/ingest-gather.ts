import source from '../../../../../shaders/stages/ingest-gather.wgsl?raw';
import { PACKING_STRUCTS } from '../../data/layout/packing-structs.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';

/** Takes one word of the splats of a page that a list names. */
export const ingestGather: StageDefinition = /* @__PURE__ */ computeStage('ingest-gather', {
  source,
  structs: PACKING_STRUCTS,
});
