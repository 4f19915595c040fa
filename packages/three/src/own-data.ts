/**
 * Splats of your own, edits, morphs and bones of splats, and splats that the GPU makes
 * (`@websplatter/three/own-data`), apart from the rest: pages that only show files do not download it.
 *
 * @module
 */
export {
  type EditedRows,
  type EditedValues,
  type RowRange,
  type SkinWeights,
  type SplatArrays,
  SplatEdits,
  splatsFromArrays,
} from '@websplatter/core/own-data';
export { bindSkeleton } from './own-data/bind-skeleton.ts';
export { editsOf } from './own-data/edits-of.ts';
export {
  type GpuColumn,
  type GpuSplatData,
  type MakeGpuSplatsOptions,
  makeGpuSplats,
} from './own-data/make-gpu-splats.ts';
export { type MorphData, makeMorphData } from './own-data/make-morph-data.ts';
export { type MakeSplatDataOptions, makeSplatData, type SplatDataInput } from './own-data/make-splat-data.ts';
export { type BoneWeightsOptions, weightsFromBones } from './own-data/weights-from-bones.ts';
