export type { SplatReach as EffectReach } from '../camera/frustum.ts';
export { SplatSelection } from '../splats/splat-selection.ts';
export { antialias } from './antialias.ts';
export { brightness } from './brightness.ts';
export {
  type ClipBox,
  type ClipOptions,
  type ClipPlane,
  type ClipSphere,
  type ClipVolume,
  clip,
  type Quaternion,
} from './clip.ts';
export {
  defineEffect,
  type EffectDefinition,
  type EffectFunction,
  type EffectHooks,
  type EffectPlace,
  type EffectUse,
  type SplatEffect,
} from './effect.ts';
export { type FogBetween, type FogOfDensity, type FogOptions, fog } from './fog.ts';
export { type HighlightOptions, highlight } from './highlight.ts';
export { opacity } from './opacity.ts';
export { type RevealOptions, reveal } from './reveal.ts';
export { tint } from './tint.ts';
