import type { Vec3 } from '../../data/math/mat4.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';

/** Sampled splats of one cloud, as they are stored, and their places in the world. */
export interface SampledSplats {
  readonly precision: GeometryPrecision;
  /** GEOMETRY_WORDS of each. */
  readonly words: Uint32Array<ArrayBuffer>;
  /** Of each: least log scale of its chunk, and the step of its packed log scales. */
  readonly logScales: Float32Array<ArrayBuffer>;
  /** Of each: number of its instance. */
  readonly instances: Uint32Array<ArrayBuffer>;
  /** Point that stored positions are relative to. */
  readonly origin: Vec3;
  /** Of each instance: cloud to world, 16 numbers, column-major; and a factor of opacity. */
  readonly matrices: Float64Array<ArrayBuffer>;
  readonly opacities: Float64Array<ArrayBuffer>;
}
