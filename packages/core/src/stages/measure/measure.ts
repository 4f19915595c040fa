import { COMPARE_CONSTANTS, COMPARE_STRUCTS } from '../../data/layout/compare-structs.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import { familyTexts } from '../family-texts.ts';

const texts = /* @__PURE__ */ familyTexts(
  import.meta.glob('./*.wgsl', { query: '?raw', import: 'default', eager: true }),
  COMPARE_STRUCTS,
);

/** Samples of a pixel, along each side. */
export const SAMPLES_PER_SIDE = 4;

/** Averages squares of samples into the pixels of a smaller image, in rgba32float. */
export const averageSamples: StageDefinition = /* @__PURE__ */ computeStage('average-samples', {
  texts,
  constants: { SAMPLES_PER_SIDE },
});

/** Compares layers of equal size: writes a `CompareTile` per tile, counts absolute errors. */
export const compareImages: StageDefinition = /* @__PURE__ */ computeStage('compare-images', {
  texts,
  constants: COMPARE_CONSTANTS,
});

/**
 * Errors are counted by the upper half of their float32 bits: errors of one count lie within 1/128
 * of one another.
 */
const DROPPED_BITS = 16;

/** Number of counts for errors of 0…1. The first stays 0: equal values follow from the others. */
export const ERROR_COUNTS = 1 + (0x3f800000 >> DROPPED_BITS);

/** Returns the middle of the errors that are counted at `index`. */
export function countedError(index: number): number {
  const bits = Uint32Array.of((index << DROPPED_BITS) + (1 << (DROPPED_BITS - 1)));
  return Math.min(1, new Float32Array(bits.buffer)[0]);
}

/** Threads per workgroup, each of which copies 16 bytes. */
export const COPY_WORKGROUP = 256;
/** Workgroups in the first dimension of a dispatch: no more than any device allows. */
export const COPY_ROW = 32_768;

/** Copies one buffer to another of the same size, a multiple of 16 bytes. */
export const copyWords: StageDefinition = /* @__PURE__ */ computeStage('copy-words', {
  texts,
  constants: { COPY_WORKGROUP, COPY_ROW },
});
