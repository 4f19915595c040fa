/**
 * Splats of your own, and edits, morphs and skins of splats (`@websplatter/core/own-data`), apart from
 * the engine: pages that only show files do not download it.
 *
 * @module
 */

export { type SplatArrays, splatsFromArrays } from './data/editing/splats-from-arrays.ts';
export { packSet } from './data/packing/pack-set.ts';
export { colorDcOf, colorOf } from './data/splats/color-values.ts';
export { flushEdits, followEdits } from './features/edits/edits.clouds.ts';
export {
  EDITED,
  type EditedRows,
  type EditedValues,
  type EditsFollower,
  type RowRange,
  SplatEdits,
} from './features/edits/splat-edits.data.ts';
export { followMorph } from './features/morph/morph.clouds.ts';
export { type MorphState, SplatMorph } from './features/morph/splat-morph.data.ts';
export { followSkin } from './features/skin/skin.clouds.ts';
export { type SkinWeights, SplatSkin } from './features/skin/splat-skin.data.ts';
