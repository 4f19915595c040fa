/**
 * Splats of your own, and edits of any splats (`@websplatter/core/own-data`), apart from the engine: who only shows files does not
 * download it.
 */
export { followEdits } from './clouds/cloud-editor.ts';
export { type SplatArrays, splatsFromArrays } from './editing/splats-from-arrays.ts';
export { packSet } from './packing/pack-set.ts';
export { colorDcOf } from './splats/color-values.ts';
export {
  EDITED,
  type EditedRows,
  type EditedValues,
  type RowRange,
  SplatEdits,
} from './splats/splat-edits.ts';
