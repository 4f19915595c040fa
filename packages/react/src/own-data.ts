/**
 * Splats from arrays, edits, morphs and bones, as in `@websplatter/three/own-data`, with hooks.
 *
 * @module
 */
'use client';

// For applications that install only this package.
export {
  type BoneWeightsOptions,
  bindSkeleton,
  type EditedRows,
  type EditedValues,
  editsOf,
  type GpuColumn,
  type GpuSplatData,
  type MakeGpuSplatsOptions,
  type MakeSplatDataOptions,
  type MorphData,
  makeGpuSplats,
  makeMorphData,
  makeSplatData,
  type RowRange,
  type SkinWeights,
  type SplatArrays,
  type SplatDataInput,
  SplatEdits,
  weightsFromBones,
} from '@websplatter/three/own-data';
