import type { SplatSet } from '@websplatter/core';

/** A colour channel 0…1 is 0.5 + its coefficient · SH_C0. */
const SH_C0 = 0.28209479177387814;

/** Successive multiples, in turns, place points around a circle as far apart as possible. */
export const GOLDEN_RATIO = (1 + Math.sqrt(5)) / 2;

export interface SceneSplat {
  readonly position: readonly number[];
  /** Standard deviation of each axis, or of all. */
  readonly scale: number | readonly number[];
  /** Direction of the splat's y axis, of any length; default: up. */
  readonly axis?: readonly number[];
  /** Channels above 1 are clamped. */
  readonly color: readonly number[];
  /** Logit of the opacity; default 2. */
  readonly opacityLogit?: number;
}

/** Makes `count` splats by calling `at` with each index. */
export function splatsOf(count: number, at: (index: number) => SceneSplat): SplatSet {
  const positions = new Float32Array(3 * count);
  const logScales = new Float32Array(3 * count);
  const rotations = new Float32Array(4 * count);
  const opacityLogits = new Float32Array(count);
  const colorDc = new Float32Array(3 * count);
  for (let i = 0; i < count; i++) {
    const { position, scale, axis = [0, 1, 0], color, opacityLogit = 2 } = at(i);
    positions.set(position, 3 * i);
    logScales.set((typeof scale === 'number' ? [scale, scale, scale] : scale).map(Math.log), 3 * i);
    rotations.set(turnFromUp(axis), 4 * i);
    opacityLogits[i] = opacityLogit;
    colorDc.set(
      color.map((value) => (Math.min(1, value) - 0.5) / SH_C0),
      3 * i,
    );
  }
  return {
    count,
    origin: [0, 0, 0],
    positions,
    logScales,
    rotations,
    opacityLogits,
    colorDc,
    harmonics: { degree: 0, coefficients: new Float32Array(0) },
    fileIndices: Uint32Array.from({ length: count }, (_, i) => i),
    dropped: {},
  };
}

/** Quaternion, w first, of the shortest rotation from the y axis; for −y, any half turn. */
function turnFromUp([x, y, z]: readonly number[]): number[] {
  const length = Math.hypot(x, y, z);
  const w = length + y;
  if (w < 1e-6 * length) return [0, 1, 0, 0];
  const norm = Math.hypot(w, z, x);
  return [w / norm, z / norm, 0, -x / norm];
}

/** A pseudorandom number in 0…1, always the same for an index and seed. */
export function hash(index: number, seed = 0): number {
  const value = Math.sin(index * 12.9898 + seed * 78.233) * 43758.5453;
  return value - Math.floor(value);
}

/** A hue as RGB, `turns` around the colour wheel. */
export function wheel(turns: number, middle = 0.55, range = 0.4): number[] {
  return [0, 1, 2].map((third) => middle + range * Math.cos(2 * Math.PI * (turns - third / 3)));
}
