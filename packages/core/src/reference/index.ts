export { type CompareOptions, compareImages, type ImageDifference } from './compare-images.ts';
export type { EffectTwin, ScreenValues, SplatValues } from './effects/effect-twin.ts';
export type { TwinFunction } from './effects/twins.ts';
export type { ReferenceImage } from './rasterize.ts';
export { type ReferenceFrame, renderReference } from './render.ts';
export { type TracedSplat, type TraceOptions, traceSplat } from './trace-splat.ts';
