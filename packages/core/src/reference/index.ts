export { type CompareOptions, compareImages, type ImageDifference } from './compare-images.ts';
export type { EffectReference, ScreenValues, SplatValues } from './effects/effect-reference.ts';
export type { ReferenceFunction } from './effects/references.ts';
export type { ReferenceImage } from './rasterize.ts';
export {
  type ReferenceFrame,
  type ReferenceTurns,
  renderReference,
  renderReferenceInTurns,
} from './render.ts';
export { type TracedSplat, type TraceOptions, traceSplat } from './trace-splat.ts';
