'use client';

export { useSplatAccuracy, useSplatEffects, useSplatMemory } from './use-engine.ts';
export { type SplatsLoad, useSplatsLoad } from './use-splats-load.ts';
export { type StageTimingsSource, useStageTimings } from './use-stage-timings.ts';
