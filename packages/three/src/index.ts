export {
  createSplatRenderer,
  isSupported,
  onDeviceLost,
  type SplatRendererParameters,
  splatEngineOf,
} from './create-splat-renderer.ts';
export {
  SplatsPassError,
  SplatsPrecisionError,
  SplatsUnsupportedRendererError,
  ThreeInternalsError,
} from './errors.ts';
export { type SplatCloudEventMap, SplatCloudObject, type SplatHit } from './splat-cloud-object.ts';
export { SplatData } from './splat-data.ts';
export { SplatLoader } from './splat-loader.ts';
export { onStageTimings } from './stage-timings.ts';
