import type { Vec3 } from '../data/math/mat4.ts';
import { coefficientsPerSplat, type ShDegree, type SplatSet } from '../data/splats/splat-set.ts';
import { seededRandom } from './seeded-random.ts';

export interface RandomSplatOptions {
  readonly count: number;
  /** Default 1. */
  readonly seed?: number;
  /** Default 3. */
  readonly shDegree?: ShDegree;
  /** Centres lie within ± this of the origin on each axis; default 1. */
  readonly halfExtent?: number;
  /** Default 0, 0, 0. */
  readonly origin?: Vec3;
  /** Range of the log scales; default −5…−2. */
  readonly logScales?: readonly [min: number, max: number];
  /** Range of the opacity's logit; default −4…4. */
  readonly opacityLogits?: readonly [min: number, max: number];
  /**
   * Range of the coefficients of degree 0; default −1.5…1.5, whose colours are 0.08…0.92. Colours of
   * captures lie below 0 and above 1 here and there.
   */
  readonly colorDc?: readonly [min: number, max: number];
}

/** Random splats in a cube, every column filled; equal options give equal splats. */
export function randomSplats(options: RandomSplatOptions): SplatSet {
  const { count, seed = 1, shDegree = 3, halfExtent = 1, origin = [0, 0, 0] } = options;
  const { logScales = [-5, -2], opacityLogits = [-4, 4], colorDc = [-1.5, 1.5] } = options;
  const random = seededRandom(seed);
  const column = (length: number, min: number, max: number) =>
    Float32Array.from({ length }, () => min + (max - min) * random());
  const coefficients = column(count * coefficientsPerSplat(shDegree), -0.3, 0.3);
  return {
    count,
    origin,
    positions: column(3 * count, -halfExtent, halfExtent),
    logScales: column(3 * count, ...logScales),
    rotations: column(4 * count, -1, 1),
    opacityLogits: column(count, ...opacityLogits),
    colorDc: column(3 * count, ...colorDc),
    harmonics: { degree: shDegree, coefficients },
    fileIndices: Uint32Array.from({ length: count }, (_, i) => i),
    dropped: {},
  };
}

/** Random splats: a third share places, so that file order decides; a few are not finite. */
export function splatsWithTies(count: number, shDegree: ShDegree, droppedEvery = 0): SplatSet {
  const set = randomSplats({ count, seed: count + shDegree, shDegree });
  for (let i = 0; i < count; i += 3) set.positions.copyWithin(3 * i, 0, 3);
  for (let i = 1; droppedEvery > 0 && i < count; i += droppedEvery) set.positions[3 * i + 1] = Number.NaN;
  return set;
}

/** Properties of one splat; the defaults are a round, opaque, grey splat at the origin. */
export interface SplatValues {
  readonly position?: readonly number[];
  readonly logScales?: readonly number[];
  readonly rotation?: readonly number[];
  readonly opacityLogit?: number;
  readonly colorDc?: readonly number[];
}

/** Makes splats of degree 0 from their properties, one by one. */
export function splatsOf(splats: readonly SplatValues[]): SplatSet {
  return {
    count: splats.length,
    origin: [0, 0, 0],
    positions: Float32Array.from(splats.flatMap(({ position = [0, 0, 0] }) => position)),
    logScales: Float32Array.from(splats.flatMap(({ logScales = [-2, -2, -2] }) => logScales)),
    rotations: Float32Array.from(splats.flatMap(({ rotation = [1, 0, 0, 0] }) => rotation)),
    opacityLogits: Float32Array.from(splats, ({ opacityLogit = Number.POSITIVE_INFINITY }) => opacityLogit),
    colorDc: Float32Array.from(splats.flatMap(({ colorDc = [0, 0, 0] }) => colorDc)),
    harmonics: { degree: 0, coefficients: new Float32Array() },
    fileIndices: Uint32Array.from(splats, (_, i) => i),
    dropped: {},
  };
}
