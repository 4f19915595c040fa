import { gpuStruct } from './gpu-struct.ts';
import type { ShaderStruct } from './structs.ts';

export const CompareParameters = gpuStruct('CompareParameters', { background: 'vec3f' });

/** Difference of one tile of two images; sums over its pixels and r, g, b. */
export const CompareTile = gpuStruct('CompareTile', {
  squaredErrorSum: 'f32',
  maxError: 'f32',
  /** Sum of 1 − structural similarity. */
  dissimilaritySum: 'f32',
  /** Number of pixels with a non-finite value. */
  brokenActual: 'u32',
  brokenExpected: 'u32',
});

/** Constants of compare-images, which come with it. */
export const COMPARE_CONSTANTS = {
  /** Side of the square of pixels that one workgroup compares. */
  COMPARE_TILE_PX: 16,
  /** Radius of the Gaussian window of structural similarity. */
  SSIM_RADIUS_PX: 5,
} as const;

/** Structs of compare-images, which come with it. */
export const COMPARE_STRUCTS: readonly ShaderStruct[] = [CompareParameters, CompareTile];
