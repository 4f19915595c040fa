import source from '../../../../../shaders/stages/compare-images.wgsl?raw';
import { COMPARE_CONSTANTS, COMPARE_STRUCTS } from '../../data/layout/compare-structs.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';

/** Compares layers of equal size: writes a `CompareTile` per tile, counts absolute errors. */
export const compareImages: StageDefinition = /* @__PURE__ */ computeStage('compare-images', {
  source,
  structs: COMPARE_STRUCTS,
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
