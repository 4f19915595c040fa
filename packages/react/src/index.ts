/**
 * `<SplatCanvas>`, `<Splats>` and what most apps need beside them, for react-three-fiber.
 *
 * @module
 */
'use client';

// Types, classes and errors of the components, for applications that install only this package.
export {
  type Accuracy,
  type AccuracyChoice,
  type AccuracyRequest,
  type AccuracyTarget,
  CodeUnavailableError,
  DestroyedError,
  type Detail,
  type FrameStatistics,
  GpuLimitError,
  InvalidArgumentError,
  RecoveryPace,
  ShaderError,
  SplatFileError,
  SplatSourceError,
  setWorkerUrl,
  WebGpuUnavailableError,
  WebSplatterError,
} from '@websplatter/core';
export {
  type EffectUse,
  type RevealOptions,
  SplatSelection,
  type Volume,
} from '@websplatter/core/effects';
export {
  type AdoptRendererOptions,
  adoptRenderer,
  isSupported,
  onDeviceLost,
  type PickEvent,
  type RevealAnimation,
  SplatData,
  type SplatHit,
  SplatLoader,
  SplatsPassError,
  SplatsPrecisionError,
  SplatsStreamError,
  SplatsUnsupportedRendererError,
  setSplatDetail,
  splatEngineOf,
  splatLimits,
  ThreeInternalsError,
} from '@websplatter/three';
export { type CanvasRendererParameters, createSplatRenderer } from './create-splat-renderer.ts';
export type { EffectProps, SplatColor } from './effect-props.ts';
export type { SplatFileSource } from './splat-cache.ts';
export { SplatCanvas, type SplatCanvasProps } from './splat-canvas.tsx';
export { SplatCloudObject } from './splat-cloud-object.ts';
export { Splats, type SplatsProps } from './splats.tsx';
export { SplatsErrorBoundary, type SplatsErrorBoundaryProps } from './splats-error-boundary.tsx';
export { type UseSplatsOptions, useSplats } from './use-splats.ts';
