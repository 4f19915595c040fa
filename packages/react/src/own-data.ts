/**
 * Splats from arrays, edits and morphs, as in `@websplatter/three/own-data`, with hooks.
 *
 * @module
 */
'use client';

// For applications that install only this package.
export {
  type EditedRows,
  type EditedValues,
  editsOf,
  type MakeSplatDataOptions,
  type MorphData,
  makeMorphData,
  makeSplatData,
  type RowRange,
  type SplatArrays,
  type SplatDataInput,
  SplatEdits,
} from '@websplatter/three/own-data';
