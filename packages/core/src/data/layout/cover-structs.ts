import { gpuStruct } from './gpu-struct.ts';
import type { ShaderStruct } from './structs.ts';

export const CoverParameters = gpuStruct('CoverParameters', { pointCount: 'u32' });

/** A point in front of which splats are sought. */
export const CoverPoint = gpuStruct('CoverPoint', {
  /** Middle of its pixel, from the layer's top left. */
  pixelPx: 'vec2f',
  /** Splats at less view depth are in front of it, world units. */
  depthView: 'f32',
  /** The same depth as the host stores it. */
  storedDepth: 'f32',
});

/** Constants of the stage `cover-points`, which come with it. */
export const COVER_CONSTANTS = {
  /**
   * Steps in which −ln(1 − opacity) is added up: 4 for the faintest splat, 4,716 for the most
   * opaque, so 900,000 of these fit.
   */
  COVER_UNITS: 1024,
} as const;

/** Structs of the stage `cover-points`, which come with it. */
export const COVER_STRUCTS: readonly ShaderStruct[] = [CoverParameters, CoverPoint];
