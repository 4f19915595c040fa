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
 * Errors are counted in a histogram. The upper 16 bits of a float32 are the index of its bin, so errors of
 * one bin differ by at most 1/128 of their size.
 */
const DROPPED_BITS = 16;

/** Number of bins, for errors of 0…1. Bin 0 stays 0: the number of equal values follows from the others. */
export const ERROR_COUNTS = 1 + (0x3f800000 >> DROPPED_BITS);

/** Returns the middle of the errors of bin `index`. */
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
