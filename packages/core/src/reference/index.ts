/**
 * The float64 renderer that defines the correct picture. Slow, without a GPU: for tests.
 *
 * @module
 */
export {
  type CompareOptions,
  compareImages,
  type ImageDifference,
} from '../stages/measure/measure.reference.ts';
export type { ReferenceImage } from '../stages/quads/quads.reference.ts';
export type { EffectReference, ScreenValues, SplatValues } from './effects/effect-reference.ts';
export type { ReferenceFunction } from './effects/references.ts';
export {
  type ReferenceFrame,
  type ReferenceTurns,
  renderReference,
  renderReferenceInTurns,
} from './render.ts';
export { type TracedSplat, type TraceOptions, traceSplat } from './trace-splat.ts';
