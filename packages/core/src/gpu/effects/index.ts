/**
 * Effects for frames: volumes, tint, fog, reveal and others, and `defineEffect` for your own.
 *
 * @module
 */
export type { SplatReach as EffectReach } from '../../data/camera/frustum.ts';
export { SplatSelection } from '../../data/splats/splat-selection.ts';
export {
  defineEffect,
  type EffectDefinition,
  type EffectFunction,
  type EffectHooks,
  type EffectPlace,
  type EffectUse,
  type SplatEffect,
} from './effect.ts';
export * from './effects.ts';
