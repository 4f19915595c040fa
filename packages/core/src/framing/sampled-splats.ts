import type { Vec3 } from '../data/math/mat4.ts';
import type { GeometryPrecision } from '../data/packing/precision.ts';

/** Sampled splats of one cloud, as stored, with the instances that they belong to. */
export interface SampledSplats {
  readonly precision: GeometryPrecision;
  /** GEOMETRY_WORDS per splat. */
  readonly words: Uint32Array<ArrayBuffer>;
  /** Per splat: the least log scale of its chunk, and the step of packed log scales. */
  readonly logScales: Float32Array<ArrayBuffer>;
  /** Instance index per splat. */
  readonly instances: Uint32Array<ArrayBuffer>;
  /** Point that stored positions are relative to. */
  readonly origin: Vec3;
  /**
   * Per instance: a matrix from cloud to world, 16 numbers, column-major; and a factor of opacity.
   */
  readonly matrices: Float64Array<ArrayBuffer>;
  readonly opacities: Float64Array<ArrayBuffer>;
}
