/**
 * Hooks for apps that manage loading, devices or timing themselves.
 *
 * @module
 */
'use client';

export type { SplatDevice } from './splat-device.ts';
export { useSplatDevice } from './splat-device.ts';
export {
  type SplatStream,
  useSplatAccuracy,
  useSplatEffects,
  useSplatMemory,
  useSplatStreams,
} from './use-engine.ts';
export { type SplatCollider, type SplatColliderOptions, useSplatCollider } from './use-splat-collider.ts';
export { type SplatsLoad, useSplatsLoad } from './use-splats-load.ts';
export { type StageTimingsSource, useStageTimings } from './use-stage-timings.ts';
