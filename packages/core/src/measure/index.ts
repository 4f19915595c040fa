/**
 * Measures time and error of accuracy settings and effects, for a scene, a view and a device.
 *
 * @module
 */
export type { AccuracyTarget } from '../data/accuracy/accuracy-target.ts';
export type { ImageDifference } from '../stages/measure/measure.reference.ts';
export { cameraAtDistance } from './camera-pivot.ts';
export type { SettingName } from './candidates.ts';
export { type AccuracyChoice, chooseAccuracy, chooseFrom } from './choose-accuracy.ts';
export { NonFiniteImageError } from './compare-textures.ts';
export { compareViews } from './compare-views.ts';
export { type CopyBandwidthOptions, measureCopyBandwidth } from './copy-bandwidth.ts';
export { DETAIL_SHARES } from './details.ts';
export {
  type AccuracyPoint,
  type AccuracyTable,
  countMeasureSteps,
  type MeasureAccuracyOptions,
  type MeasureProgress,
  measureAccuracy,
} from './measure-accuracy.ts';
export { type EffectCost, type MeasureEffectsOptions, measureEffects } from './measure-effects.ts';
export {
  type CountSpread,
  type FrameMeasurement,
  type FrameSpread,
  type MeasureFramesOptions,
  measureFrames,
  type PassCost,
} from './measure-frames.ts';
export type { ComparedView, MeasuredEngine, MeasuredView } from './measured-engine.ts';
export { orbitCameras } from './orbit-cameras.ts';
export { sampleCameras } from './sample-cameras.ts';
export { standardDeviation, type TimeSpread, timeSpread } from './time-spread.ts';
