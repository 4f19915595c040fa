/**
 * The engine: loads splats, draws views of them, and measures what it does. No framework.
 *
 * @module
 */
export type { CloudLease, HoldOptions } from './clouds/cloud-leases.ts';
export type { CloudMemory, CloudPage, CloudPages, HeldPrecisions } from './clouds/cloud-planes.ts';
export type { CloudFit, FitMode, FitSettings } from './clouds/fit-settings.ts';
export type { MakeRayTreeOptions } from './clouds/rays/make-ray-tree.ts';
export type { RayHit, RayOptions, RayTree, RayView } from './clouds/rays/ray-tree.ts';
export { makeRayTree } from './clouds/rays/rays.ts';
export type { CloudSource, SplatCloud } from './clouds/splat-cloud.ts';
export type { CloudStream, StreamReport } from './clouds/stream/cloud-stream.ts';
export { foreseeEngine, SplatEngine } from './create-engine.ts';
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
  type FrameRasterizer,
  type PossibleAccuracy,
  type Rasterizer,
  type RecordPrecision,
  resolveAccuracy,
  type SortKeyBits,
} from './data/accuracy/accuracy.ts';
export {
  type AccuracyRequest,
  type AccuracyTarget,
  checkAccuracy,
  isAccuracyTarget,
} from './data/accuracy/accuracy-target.ts';
export { combineAccuracies, mostExact } from './data/accuracy/combine-accuracies.ts';
export {
  type Camera,
  cameraFromMatrices,
  cameraPosition,
  type LookAtOptions,
  orthographicCamera,
  perspectiveCamera,
} from './data/camera/camera.ts';
export type { DepthConvention } from './data/camera/depth-convention.ts';
export * from './data/errors.ts';
export { callListener, Listeners } from './data/listeners.ts';
export type { Vec3 } from './data/math/mat4.ts';
export { type CloudFacts, cloudFacts } from './data/packing/cloud-facts.ts';
export { fileUp } from './data/packing/file-up.ts';
export { GEOMETRY_WORDS } from './data/packing/geometry.ts';
export {
  type Harmonics,
  type PackedHarmonics,
  type PackedPalette,
  type ReadHarmonics,
  readCoefficients,
  type StoredHarmonics,
  shWordsPerSplat,
} from './data/packing/harmonics.ts';
export type { HarmonicsPalette } from './data/packing/harmonics-palette.ts';
export {
  type Bounds,
  type PackedCloud,
  type PackOptions,
  packCloud,
  transferablesOf,
} from './data/packing/packed-cloud.ts';
export type { CloudPrecision, GeometryPrecision, ShPrecision } from './data/packing/precision.ts';
export { printable, shown } from './data/printable.ts';
export { SORTED_BY, type SortBy } from './data/splats/sort-by.ts';
export {
  coefficientsPerSplat,
  type DropCounts,
  type DropReason,
  type FileFacts,
  type ShDegree,
  type SplatColumns,
  type SplatSet,
  type TrainedHarmonics,
} from './data/splats/splat-set.ts';
export type {
  DrawnAccuracy,
  EngineMemory,
  EngineOptions,
  LoadOptions,
  PrecisionProblem,
  SetAccuracyOptions,
} from './engine.ts';
export type {
  GpuSplatFaults,
  GpuSplats,
  GpuSplatsOptions,
  SplatBuffer,
} from './features/gpu-splats/gpu-splats.clouds.ts';
export { motionBytesOf, type PackedMotion } from './features/motion/pack-motion.data.ts';
export { MOTION_SLOT, MOTION_VALUES, type TimeRange } from './features/motion/splat-motion.data.ts';
export type { EffectEntry } from './frame/ledger/ledger.ts';
export type { HostPass } from './frame/parts/frame-part.ts';
export type { EmbeddedImage } from './frame/parts/host-textures.ts';
export type { CloudInstances } from './frame/plan/cloud-instances.ts';
export {
  checkDetail,
  type Detail,
  type DetailLimits,
  type FixedDetail,
  isFixedDetail,
} from './frame/plan/detail.ts';
export type { CloudInstance, FrameRequest } from './frame/plan/frame-request.ts';
export type { FrameSceneOptions } from './framing/frame-clouds.ts';
export { frameScene } from './framing/frame-scene.ts';
export type { SceneFraming, SceneKind } from './framing/scene-framing.ts';
export {
  adapterLabel,
  type DeviceOptions,
  isSoftwareAdapter,
  requestSplatDevice,
  sceneLimits,
} from './gpu/device.ts';
export type { EngineCounters } from './gpu/engine-counters.ts';
export type { GpuMemoryReport } from './gpu/gpu-memory.ts';
export type { TextureImage } from './gpu/read-texture.ts';
export { RecoveryPace } from './gpu/recovery-pace.ts';
export {
  type FrameStatistics,
  isPlausible,
  type StageTimings,
  type TimedPass,
  wallClockTimings,
} from './gpu/timing/frame-statistics.ts';
export type { SplatFormatName } from './io/formats/formats.ts';
export { encodePly } from './io/formats/ply/write-ply.ts';
export { type LoadSplatsOptions, loadSplats } from './io/loading/load-splats.ts';
export { readSplats } from './io/loading/read-splats.ts';
export { setWorkerUrl } from './io/loading/start-worker.ts';
export { lastingSource } from './io/sources/known-source.ts';
export type {
  LastingSource,
  LoadProgress,
  ReadLimits,
  ReadOptions,
  RequestOptions,
  SceneFiles,
  SourceOptions,
  SplatFrame,
  SplatSource,
} from './io/sources/splat-source.ts';
export type { AccuracyChoice } from './measure/choose-accuracy.ts';
export type { MeasureProgress } from './measure/measure-accuracy.ts';
export type { ChooseAccuracyOptions } from './views/accuracy-targets.ts';
export type { EmbeddedFrameRequest, EmbeddedView } from './views/embedded-view.ts';
export type { PointCoverage, PointToCover } from './views/find-coverage.ts';
export type { SplatPick } from './views/pick-splat.ts';
export type { RasterizerReport } from './views/rasterizer-choice.ts';
export type { SplatView } from './views/splat-view.ts';
export type { DetailReport } from './views/view-detail.ts';
