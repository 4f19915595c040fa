/**
 * Splats of your own, edits of any splats, and morphs (`@websplatter/three/own-data`), apart from
 * the rest: pages that only show files do not download it.
 *
 * @module
 */
export {
  type EditedRows,
  type EditedValues,
  type RowRange,
  type SplatArrays,
  SplatEdits,
  splatsFromArrays,
} from '@websplatter/core/own-data';
export { editsOf } from './edits-of.ts';
export { type MorphData, makeMorphData } from './make-morph-data.ts';
export { type MakeSplatDataOptions, makeSplatData, type SplatDataInput } from './make-splat-data.ts';
