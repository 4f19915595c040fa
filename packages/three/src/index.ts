/**
 * Splats as objects of three.js scenes, drawn and sorted together, with meshes between them.
 *
 * @module
 */

// Apps that install only this package need these of core, too: all errors, and the worker's address.
export {
  CodeUnavailableError,
  DestroyedError,
  GpuLimitError,
  InvalidArgumentError,
  ShaderError,
  SplatFileError,
  SplatSourceError,
  setWorkerUrl,
  WebGpuUnavailableError,
  WebSplatterError,
} from '@websplatter/core';
export {
  type FrameSplatsOptions,
  type FramingCamera,
  frameSplats,
  placeCamera,
} from './cloud/frame-splats.ts';
export {
  type PickEvent,
  type SplatCloudEventMap,
  SplatCloudObject,
  type SplatHit,
} from './cloud/splat-cloud-object.ts';
export { type DataOptions, type LoadedCloud, SplatData } from './cloud/splat-data.ts';
export { SplatInstances } from './cloud/splat-instances.ts';
export { SplatLoader } from './cloud/splat-loader.ts';
export {
  SplatsPassError,
  SplatsPrecisionError,
  SplatsStreamError,
  SplatsUnsupportedRendererError,
  ThreeInternalsError,
} from './errors.ts';
export {
  type AdoptRendererOptions,
  adoptRenderer,
  findSplatEngine,
  onDeviceLost,
  setSplatDetail,
  splatEngineOf,
} from './renderer/adopt-renderer.ts';
export {
  createSplatRenderer,
  isSupported,
  type SplatRendererParameters,
  splatLimits,
} from './renderer/create-splat-renderer.ts';
export { LoopPace } from './renderer/loop-pace.ts';
export { onStageTimings } from './renderer/stage-timings.ts';
export { encodedColor, volumeOf } from './scene/effect-options.ts';
export { checkedReveal, type RevealAnimation } from './scene/reveal-animation.ts';
export { coverageOf, pickSplat } from './scene/scene-queries.ts';
export { SplatVolumeObject, type SplatVolumeParameters } from './scene/splat-volume-object.ts';
