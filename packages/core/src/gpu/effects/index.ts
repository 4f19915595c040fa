/**
 * Effects for frames: volumes, tint, fog, reveal and others, and `defineEffect` for your own.
 *
 * @module
 */
export type { SplatReach as EffectReach } from '../../data/camera/frustum.ts';
export { SplatSelection } from '../../data/splats/splat-selection.ts';
export { defineEffect } from './define-effect.ts';
export type {
  EffectDefinition,
  EffectFunction,
  EffectHooks,
  EffectPlace,
  EffectResources,
  EffectRows,
  EffectUse,
  SplatEffect,
} from './effect.ts';
export {
  type EffectResource,
  type EffectResourceType,
  effectResources,
  type GivenResource,
} from './effect-resources.ts';
export * from './effects.ts';
export { type RelightLight, type RelightOptions, relight } from './relight/relight.ts';
export type { LightCone, LightFalloff } from './shadows/light-cone.ts';
export { type ShadowLight, type ShadowsOptions, shadows } from './shadows/shadows.ts';
export { splatRows } from './splat-rows.ts';
