/** Splats that are sampled, at most. With a quarter of them, 2 of 14 captures came out worse. */
export const MOST_SAMPLES = 1 << 16;

/** Some splats of a scene, spread evenly over all of them, in world space. */
export interface SplatSample {
  /** N. */
  readonly count: number;
  /** Splats of the scene that each stands for, in the mean: at least 1. */
  readonly weight: number;
  /** 3N: x, y and z of the centres. */
  readonly positions: Float64Array<ArrayBuffer>;
  /** N, 0…1. */
  readonly opacities: Float32Array<ArrayBuffer>;
  /** 3N: standard deviations along the splat's axes, ascending. */
  readonly sigmas: Float32Array<ArrayBuffer>;
  /** 3N: unit vectors along the shortest axis. */
  readonly normals: Float32Array<ArrayBuffer>;
  /** 3N: base colours as trained: the SH coefficients of degree 0. */
  readonly colors: Float32Array<ArrayBuffer>;
}
