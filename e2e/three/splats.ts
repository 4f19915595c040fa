import { packCloud, type SplatSet } from '@websplatter/core';
import { SplatCloudObject, SplatData } from '@websplatter/three';

/** A splat as people would describe it. */
export interface SplatDescription {
  readonly position?: readonly [number, number, number];
  /** Standard deviations along x, y and z. */
  readonly scale?: readonly [number, number, number];
  /** 0…1, of the splat's middle. */
  readonly opacity?: number;
  /** sRGB-encoded, 0…1. */
  readonly color?: readonly [number, number, number];
}

const SH_C0 = 0.28209479177387814;

/** Much larger than any image: its opacity is the same all over. */
const FLAT_SCALE = [500, 500, 0.001] as const;

export function splatSet(splats: readonly SplatDescription[]): SplatSet {
  const count = splats.length;
  const numbers = (read: (splat: SplatDescription) => readonly number[]) =>
    Float32Array.from(splats.flatMap((splat) => [...read(splat)]));
  return {
    count,
    origin: [0, 0, 0],
    positions: numbers(({ position = [0, 0, 0] }) => position),
    logScales: numbers(({ scale = FLAT_SCALE }) => scale.map(Math.log)),
    rotations: numbers(() => [1, 0, 0, 0]),
    opacityLogits: numbers(({ opacity = 0.5 }) => [Math.log(opacity / (1 - opacity))]),
    colorDc: numbers(({ color = [1, 1, 1] }) => color.map((value) => (value - 0.5) / SH_C0)),
    harmonics: { degree: 0, coefficients: new Float32Array(0) },
    fileIndices: Uint32Array.from(splats, (_, i) => i),
    dropped: {},
  };
}

/** Coloured splats of many sizes and opacities in a cube about the origin, always the same. */
export function manySplats(count: number): SplatDescription[] {
  let state = 1;
  // Numerical Recipes' generator.
  const next = () => {
    state = (1664525 * state + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
  const three = (make: () => number): [number, number, number] => [make(), make(), make()];
  return Array.from({ length: count }, () => ({
    position: three(() => 2 * next() - 1),
    scale: three(() => 0.005 + 0.02 * next()),
    opacity: 0.1 + 0.8 * next(),
    color: three(next),
  }));
}

/** Small black and white splats in rows across the view on the left, over a sky far behind. */
export function checkeredSplats(): SplatDescription[] {
  const checkered: SplatDescription[] = [];
  for (let row = -12; row <= 12; row++)
    for (let column = -12; column <= 0; column++) {
      const value = (row + column) & 1 ? 1 : 0;
      checkered.push({
        position: [0.14 * column - 0.15, 0.14 * row, 0],
        scale: [0.07, 0.07, 0.001],
        opacity: 0.9,
        color: [value, value, value],
      });
    }
  return [...checkered, { position: [0, 0, -80], opacity: 0.99, color: [0.4, 0.6, 1] }];
}

export function splatData(...splats: SplatDescription[]): SplatData {
  return new SplatData(packCloud(splatSet(splats), { geometryPrecision: 'packed' }), 'test splats');
}

export function splatCloud(...splats: SplatDescription[]): SplatCloudObject {
  return new SplatCloudObject(splatData(...splats));
}
