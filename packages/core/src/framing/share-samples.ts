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
