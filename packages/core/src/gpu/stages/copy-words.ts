import source from '../../../../../shaders/stages/copy-words.wgsl?raw';
import { computeStage, type StageDefinition } from '../pipelines.ts';

/** Threads per workgroup, each of which copies 16 bytes. */
export const COPY_WORKGROUP = 256;
/** Workgroups in the first dimension of a dispatch: no more than any device allows. */
export const COPY_ROW = 32_768;

/** Copies one buffer to another of the same size, a multiple of 16 bytes. */
export const copyWords: StageDefinition = /* @__PURE__ */ computeStage('copy-words', {
  source,
  constants: { COPY_WORKGROUP, COPY_ROW },
});
