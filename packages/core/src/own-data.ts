/**
 * Splats of your own, and edits, morphs and skins of splats (`@websplatter/core/own-data`), apart from
 * the engine: pages that only show files do not download it.
 *
 * @module
 */
export { flushEdits, followEdits } from './clouds/cloud-editor.ts';
export { followMorph } from './clouds/cloud-morph.ts';
export { followSkin } from './clouds/cloud-skin.ts';
export { type MorphState, SplatMorph } from './data/editing/splat-morph.ts';
export { type SkinWeights, SplatSkin } from './data/editing/splat-skin.ts';
export { type SplatArrays, splatsFromArrays } from './data/editing/splats-from-arrays.ts';
export { packSet } from './data/packing/pack-set.ts';
export { colorDcOf, colorOf } from './data/splats/color-values.ts';
export {
  EDITED,
  type EditedRows,
  type EditedValues,
  type EditsFollower,
  type RowRange,
  SplatEdits,
} from './data/splats/splat-edits.ts';
