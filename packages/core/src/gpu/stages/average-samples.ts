import source from '../../../../../shaders/stages/average-samples.wgsl?raw';
import { computeStage, type StageDefinition } from '../pipelines.ts';

/** Samples of a pixel, along each side. */
export const SAMPLES_PER_SIDE = 4;

/** Averages squares of samples into the pixels of a smaller image, in rgba32float. */
export const averageSamples: StageDefinition = /* @__PURE__ */ computeStage('average-samples', {
  source,
  constants: { SAMPLES_PER_SIDE },
});
