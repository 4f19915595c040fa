/**
 * Splats of your own, and edits of any splats (`@websplatter/three/own-data`), apart from the rest:
 * pages that only show files do not download it.
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
export { type MakeSplatDataOptions, makeSplatData } from './make-splat-data.ts';
