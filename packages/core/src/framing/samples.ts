import type { Vec3 } from '../data/math/mat4.ts';
import type { GeometryPrecision } from '../data/packing/precision.ts';

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

/** Counts of a cloud's splats and instances. */
export interface SampledCount {
  readonly splats: number;
  readonly instances: number;
}

/** Chosen splats of one cloud, ascending, with one instance each. */
export interface ChosenSplats {
  readonly splats: Uint32Array<ArrayBuffer>;
  readonly instances: Uint32Array<ArrayBuffer>;
}

/** Fractional parts of its multiples are spread evenly over 0…1. */
const GOLDEN_RATIO = 0.6180339887498949;

/**
 * Chooses at most `most` splats over all instances of all clouds, spread evenly in storage order. A
 * splat with many instances is chosen in few of them, and the next splat in others.
 *
 * @returns the choice for each cloud, and the number of splats that one sample represents.
 */
export function shareSamples(
  clouds: readonly SampledCount[],
  most: number,
): { readonly chosen: readonly ChosenSplats[]; readonly weight: number } {
  const total = clouds.reduce((sum, { splats, instances }) => sum + splats * instances, 0);
  const samples = Math.min(total, most);
  /** Index of a sample among all splats of all instances of all clouds. */
  const placeOf = (sample: number) => Math.floor((sample * total) / samples);
  let sample = 0;
  let start = 0;
  const chosen = clouds.map(({ splats, instances }) => {
    const first = sample;
    const end = start + splats * instances;
    while (sample < samples && placeOf(sample) < end) sample++;
    const own = { splats: new Uint32Array(sample - first), instances: new Uint32Array(sample - first) };
    for (let i = 0; i < own.splats.length; i++) {
      const place = placeOf(first + i) - start;
      const splat = Math.floor(place / instances);
      const turned = Math.floor(((splat * GOLDEN_RATIO) % 1) * instances);
      own.splats[i] = splat;
      own.instances[i] = (place - splat * instances + turned) % instances;
    }
    start = end;
    return own;
  });
  return { chosen, weight: samples > 0 ? total / samples : 1 };
}

/**
 * Gathers the words of the splats at `slots`, in the order of `slots`; `stride` words per splat.
 */
export function pickWords(words: Uint32Array, stride: number, slots: Uint32Array): Uint32Array<ArrayBuffer> {
  const result = new Uint32Array(stride * slots.length);
  for (const [i, slot] of slots.entries())
    result.set(words.subarray(stride * slot, stride * (slot + 1)), stride * i);
  return result;
}
