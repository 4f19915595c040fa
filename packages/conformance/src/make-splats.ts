import { coefficientsPerSplat, type ShDegree, type SplatSet } from '@websplatter/core';

/** One splat. By default it is round, half-transparent, grey and at the origin. */
export interface SplatValues {
  readonly position?: readonly number[];
  /** Natural logarithms of the standard deviations. */
  readonly logScales?: readonly number[];
  /** Quaternion w, x, y, z of any length. */
  readonly rotation?: readonly number[];
  readonly opacityLogit?: number;
  /** r, g, b without the view-dependent part, sRGB-encoded, 0…1. */
  readonly color?: readonly number[];
  /** 3K coefficients above degree 0 in ascending (degree, order), each r, g, b; 0 if missing. */
  readonly shRest?: readonly number[];
}

/** Basis function of degree 0. */
const SH_C0 = Math.sqrt(1 / (4 * Math.PI));

/** Coefficient of degree 0 that gives a channel the value `channel`. */
function colorDcOf(channel: number): number {
  return (channel - 0.5) / SH_C0;
}

export function logitOf(opacity: number): number {
  return Math.log(opacity / (1 - opacity));
}

/** A splat that fills a part of the images in front of the ordinary ones. */
export const LARGE: SplatValues = {
  position: [0.3, -0.2, 1.5],
  logScales: [0.2, -0.5, -1],
  rotation: [0.8, 0.3, -0.2, 0.4],
  opacityLogit: logitOf(0.6),
  color: [1, 0.3, 0.1],
};

/** Makes a set of `splats` in this order; positions are relative to `origin`. */
export function splatsOf(
  splats: readonly SplatValues[],
  options: { readonly shDegree?: ShDegree; readonly origin?: readonly [number, number, number] } = {},
): SplatSet {
  const { shDegree = 0, origin = [0, 0, 0] } = options;
  const width = coefficientsPerSplat(shDegree);
  const coefficients = new Float32Array(splats.length * width);
  for (const [i, { shRest = [] }] of splats.entries()) coefficients.set(shRest.slice(0, width), i * width);
  return {
    count: splats.length,
    origin,
    positions: Float32Array.from(splats.flatMap(({ position = [0, 0, 0] }) => position)),
    logScales: Float32Array.from(splats.flatMap(({ logScales = [-1.5, -1.5, -1.5] }) => logScales)),
    rotations: Float32Array.from(splats.flatMap(({ rotation = [1, 0, 0, 0] }) => rotation)),
    opacityLogits: Float32Array.from(splats, ({ opacityLogit = 0 }) => opacityLogit),
    colorDc: Float32Array.from(splats.flatMap(({ color = [0.5, 0.5, 0.5] }) => color.map(colorDcOf))),
    harmonics: { degree: shDegree, coefficients },
    fileIndices: Uint32Array.from(splats, (_, i) => i),
    dropped: {},
  };
}

/** Returns uniform numbers in [0, 1), the same for the same seed on every machine (mulberry32). */
export function seededRandom(seed: number): () => number {
  let state = seed | 0;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let bits = Math.imul(state ^ (state >>> 15), state | 1);
    bits ^= bits + Math.imul(bits ^ (bits >>> 7), bits | 61);
    return ((bits ^ (bits >>> 14)) >>> 0) / 2 ** 32;
  };
}

/** Rows of a wall of splats about z = −2.5 that fills the view of `frontAndOblique`. */
const WALL_ROWS = 8;
/** Splats in front of the wall. */
const LOOSE_SPLATS = 16;

/**
 * Makes the splats that surround a scene's hard splat, so that an error shows against their
 * colours. No two have equal depths for any camera, and all lie within ±6.
 */
export function ordinarySplats(seed = 1): SplatValues[] {
  const random = seededRandom(seed);
  const within = (low: number, high: number) => low + (high - low) * random();
  const color = () => [within(0.1, 1), within(0.1, 1), within(0.1, 1)];
  const rotation = () => [within(-1, 1), within(-1, 1), within(-1, 1), within(0.1, 1)];
  const step = 10 / (WALL_ROWS - 1);
  const wall = Array.from({ length: WALL_ROWS * WALL_ROWS }, (_, i) => ({
    position: [
      -5 + step * (i % WALL_ROWS) + within(-0.3, 0.3),
      -5 + step * Math.floor(i / WALL_ROWS) + within(-0.3, 0.3),
      within(-3, -2),
    ],
    logScales: [within(-0.6, -0.2), within(-0.6, -0.2), within(-2, -1)],
    rotation: rotation(),
    opacityLogit: within(1, 4),
    color: color(),
  }));
  const loose = Array.from({ length: LOOSE_SPLATS }, () => ({
    position: [within(-2.5, 2.5), within(-2.5, 2.5), within(-1.5, 1.5)],
    logScales: [within(-3, -1.2), within(-3, -1.2), within(-3, -1.2)],
    rotation: rotation(),
    opacityLogit: within(-1, 3),
    color: color(),
  }));
  return [...wall, ...loose];
}

/** Makes 3K coefficients in ±`amplitude`, the same for the same seed. */
export function randomShRest(degree: ShDegree, amplitude: number, seed: number): number[] {
  const random = seededRandom(seed);
  return Array.from({ length: coefficientsPerSplat(degree) }, () => amplitude * (2 * random() - 1));
}

/** Moves splats by `offset`. */
export function moved(splats: readonly SplatValues[], offset: readonly number[]): SplatValues[] {
  return splats.map((splat) => ({
    ...splat,
    position: (splat.position ?? [0, 0, 0]).map((value, axis) => value + offset[axis]),
  }));
}

/** Scales splats about the origin by `factor`. */
export function resized(splats: readonly SplatValues[], factor: number): SplatValues[] {
  return splats.map((splat) => ({
    ...splat,
    position: (splat.position ?? [0, 0, 0]).map((value) => factor * value),
    logScales: (splat.logScales ?? [-1.5, -1.5, -1.5]).map((value) => value + Math.log(factor)),
  }));
}

/** Turns splats about the origin by a quaternion w, x, y, z of any length above 0. */
export function turned(
  splats: readonly SplatValues[],
  [w, x, y, z]: readonly [number, number, number, number],
): SplatValues[] {
  const length2 = w * w + x * x + y * y + z * z;
  const rows = [
    [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
  ];
  return splats.map((splat) => {
    const [px, py, pz] = splat.position ?? [0, 0, 0];
    const [rw, rx, ry, rz] = splat.rotation ?? [1, 0, 0, 0];
    return {
      ...splat,
      position: rows.map(([ofX, ofY, ofZ]) => (ofX * px + ofY * py + ofZ * pz) / length2),
      rotation: [
        w * rw - x * rx - y * ry - z * rz,
        w * rx + x * rw + y * rz - z * ry,
        w * ry - x * rz + y * rw + z * rx,
        w * rz + x * ry - y * rx + z * rw,
      ],
    };
  });
}

/** Gives each splat random coefficients above degree 0, in ±`amplitude`. */
export function withRandomSh(
  splats: readonly SplatValues[],
  degree: ShDegree,
  amplitude: number,
): SplatValues[] {
  return splats.map((splat, i) => ({ ...splat, shRest: randomShRest(degree, amplitude, i + 1) }));
}
