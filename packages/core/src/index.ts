export {
  ACCURACY_PRESETS,
  ACCURACY_SETTINGS,
  type Accuracy,
  type AccuracyPreset,
  type AccuracySetting,
  type AccuracySettings,
  type ColorTarget,
  type Culling,
  DEFAULT_ACCURACY,
  type Extent,
  type GeometryPrecision,
  type RecordPrecision,
  resolveAccuracy,
  type SortKeyBits,
} from './accuracy.ts';
export { type AccuracyRequest, type AccuracyWish, isAccuracyWish } from './accuracy-wish.ts';
export type { ChooseAccuracyOptions } from './accuracy-wishes.ts';
export {
  type Camera,
  cameraFromMatrices,
  cameraPosition,
  type LookAtOptions,
  orthographicCamera,
  perspectiveCamera,
} from './camera.ts';
export { adapterLabel, type DeviceOptions, isSoftwareAdapter, requestSplatDevice } from './device.ts';
export type { EffectEntry } from './effects/ledger.ts';
export type { EmbeddedFrame, EmbeddedPicture, EmbeddedView, HostPass } from './embedded-view.ts';
export { type EngineOptions, type PossibleAccuracy, type PrecisionProblem, SplatEngine } from './engine.ts';
export * from './errors.ts';
export type { EngineCounters } from './gpu/engine-counters.ts';
export type { GpuMemoryReport } from './gpu/gpu-memory.ts';
export type { TextureImage } from './gpu/read-texture.ts';
export { type LoadSplatsOptions, lastingSource, loadSplats } from './io/load-splats.ts';
export { readSplats } from './io/read-splats.ts';
export type { LoadProgress, ReadOptions, SplatSource } from './io/splat-source.ts';
export { encodePly } from './io/write-ply.ts';
export { GEOMETRY_WORDS } from './layout/geometry.ts';
export {
  packShRest,
  repackShRest,
  type ShPrecision,
  type ShRest,
  shRestWordsPerSplat,
  unpackShRest,
} from './layout/sh-rest.ts';
export type { Vec3 } from './math/mat4.ts';
export type { AccuracyChoice } from './measure/choose-accuracy.ts';
export type { MeasureProgress } from './measure/measure-accuracy.ts';
export type { SplatPick } from './pick.ts';
export { mostExact, pictureAccuracy } from './picture-accuracy.ts';
export type { PrecisionRequestOptions } from './precision-requests.ts';
export { type CloudFacts, cloudFacts } from './scene/cloud-facts.ts';
export type { CloudPage, CloudPages, CloudPrecision, HeldPrecisions } from './scene/cloud-planes.ts';
export type { DepthConvention } from './scene/depth-convention.ts';
export {
  type Bounds,
  type PackedCloud,
  type PackOptions,
  packCloud,
  transferablesOf,
} from './scene/packed-cloud.ts';
export { type CloudHit, raycastCloud } from './scene/raycast-cloud.ts';
export type { CloudSource, SplatCloud } from './scene/splat-cloud.ts';
export {
  type DropCounts,
  type DropReason,
  SH_REST_COEFFICIENTS,
  type ShDegree,
  type SplatSet,
} from './scene/splat-set.ts';
export type { CloudInstance, ViewFrame } from './scene/view-frame.ts';
export {
  type FrameStatistics,
  isPlausible,
  type StageTimings,
  wallClockTimings,
} from './timing/frame-statistics.ts';
export type { SplatView } from './view.ts';
