export { antialias } from './antialias.ts';
export { brightness } from './brightness.ts';
export {
  defineEffect,
  type EffectDefinition,
  type EffectFunction,
  type EffectHooks,
  type EffectPlace,
  type EffectReach,
  type EffectUse,
  type SplatEffect,
} from './effect.ts';
export { opacity } from './opacity.ts';
export { tint } from './tint.ts';
