import { PACKING_STRUCTS } from '../../data/layout/packing-structs.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import { familyTexts } from '../family-texts.ts';

const texts = /* @__PURE__ */ familyTexts(
  import.meta.glob('./*.wgsl', { query: '?raw', import: 'default', eager: true }),
  PACKING_STRUCTS,
);

/** Takes one word of the splats of a page that a list names. */
export const ingestGather: StageDefinition = /* @__PURE__ */ computeStage('ingest-gather', {
  texts,
});
