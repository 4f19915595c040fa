import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import type { SortShape } from './sort-shape.ts';

const { SCAN_WORKGROUP, SCAN_ITEMS } = SHADER_CONSTANTS;

/** Replaces each digit's counts by their exclusive sums over all blocks; writes digits' totals. */
export function sortScan({ digitBits }: Pick<SortShape, 'digitBits'>): StageDefinition {
  return computeStage('sort-scan', {
    constants: { DIGIT_BITS: digitBits },
  });
}

/** Most counts that one thread scans alone. */
const MAX_ALONE = 64;

/**
 * Number of threads that scan one digit's counts: 1 for few, otherwise 16 to 256, enough for
 * `maxBlocks` counts at a time. For few blocks, SwiftShader took 140 ms with 256 threads per digit,
 * 5 ms with 16 and 0.2 ms with one, which needs no barriers.
 */
export function scanLanesFor(maxBlocks: number): number {
  if (maxBlocks <= MAX_ALONE) return 1;
  let lanes = 16;
  while (lanes < SCAN_WORKGROUP && lanes * SCAN_ITEMS < maxBlocks) lanes *= 2;
  return lanes;
}

/** Number of workgroups that scan all digits. */
export function scanWorkgroups({ digitBits }: Pick<SortShape, 'digitBits'>, scanLanes: number): number {
  return Math.ceil((2 ** digitBits * scanLanes) / SCAN_WORKGROUP);
}
