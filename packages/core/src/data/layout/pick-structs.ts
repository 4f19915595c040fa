import { gpuStruct } from './gpu-struct.ts';
import type { ShaderStruct } from './structs.ts';

/** The pixel to pick: its centre, from the image's top left. */
export const PickParameters = gpuStruct('PickParameters', { pixelPx: 'vec2f', blockCount: 'u32' });

/** Contribution of a run of successive splats, in drawing order, to one pixel. */
export const PickBlock = gpuStruct('PickBlock', {
  /** Fraction of the light from behind the run that passes through all its splats. */
  transmittance: 'f32',
  /** Largest share of the pixel of one splat, as if nothing were in front of the run; 0 if none. */
  weight: 'f32',
  /** That splat's number, counting through all chunks of the frame. */
  splat: 'u32',
  /** Its opacity at the pixel. */
  alpha: 'f32',
  depthView: 'f32',
  /** Its rank. */
  rank: 'u32',
});

/** Constants of the stage `pick`, which come with it. */
export const PICK_CONSTANTS = {
  /** Splats, in drawing order, that one workgroup blends for a pick. */
  PICK_WORKGROUP: 256,
} as const;

/** Structs of the stage `pick`, which come with it. */
export const PICK_STRUCTS: readonly ShaderStruct[] = [PickParameters, PickBlock];
