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
  type AdoptRendererOptions,
  adoptRenderer,
  findSplatEngine,
  onDeviceLost,
  setSplatDetail,
  splatEngineOf,
} from './adopt-renderer.ts';
export {
  createSplatRenderer,
  isSupported,
  type SplatRendererParameters,
  splatLimits,
} from './create-splat-renderer.ts';
export { encodedColor, volumeOf } from './effect-options.ts';
export {
  SplatsPassError,
  SplatsPrecisionError,
  SplatsStreamError,
  SplatsUnsupportedRendererError,
  ThreeInternalsError,
} from './errors.ts';
export {
  type FrameSplatsOptions,
  type FramingCamera,
  frameSplats,
  placeCamera,
} from './frame-splats.ts';
export { LoopPace } from './loop-pace.ts';
export { checkedReveal, type RevealAnimation } from './reveal-animation.ts';
export { coverageOf, pickSplat } from './scene-queries.ts';
export {
  type PickEvent,
  type SplatCloudEventMap,
  SplatCloudObject,
  type SplatHit,
} from './splat-cloud-object.ts';
export { type DataOptions, type LoadedCloud, SplatData } from './splat-data.ts';
export { SplatInstances } from './splat-instances.ts';
export { SplatLoader } from './splat-loader.ts';
export { SplatVolumeObject, type SplatVolumeParameters } from './splat-volume-object.ts';
export { onStageTimings } from './stage-timings.ts';
