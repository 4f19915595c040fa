import type { PackedGeometry } from '../../data/packing/geometry.ts';
import { type PackedHarmonics, packCoefficients, readCoefficients } from '../../data/packing/harmonics.ts';
import { coefficientsPerSplat } from '../../data/splats/splat-set.ts';
import { type ReferenceSplat, unpackSplat } from '../../reference/packing.ts';

/** Reference of morph-geometry, in float64: the blended splats of two pages, before they are packed. */
export function morphGeometry(
  first: PackedGeometry,
  second: PackedGeometry,
  count: number,
  amount: number,
): ReferenceSplat[] {
  return Array.from({ length: count }, (_, i) =>
    morphSplat(unpackSplat(first, i), unpackSplat(second, i), amount),
  );
}

function morphSplat(a: ReferenceSplat, b: ReferenceSplat, amount: number): ReferenceSplat {
  const blend = (from: number, to: number) => from * (1 - amount) + to * amount;
  const sign = dot(a.rotation, b.rotation) < 0 ? -1 : 1;
  const rotation = four((k) => blend(a.rotation[k], sign * b.rotation[k]));
  const length = Math.sqrt(dot(rotation, rotation));
  return {
    position: three((axis) => blend(a.position[axis], b.position[axis])),
    opacity: blend(a.opacity, b.opacity),
    rotation: four((k) => rotation[k] / length),
    scale: three((axis) => Math.exp(blend(Math.log(a.scale[axis]), Math.log(b.scale[axis])))),
    colorDc: three((channel) => blend(a.colorDc[channel], b.colorDc[channel])),
  };
}

function dot(a: readonly number[], b: readonly number[]): number {
  return a.reduce((sum, value, k) => sum + value * b[k], 0);
}

function three(of: (k: number) => number): [number, number, number] {
  return [of(0), of(1), of(2)];
}

function four(of: (k: number) => number): [number, number, number, number] {
  return [of(0), of(1), of(2), of(3)];
}

/** Reference of morph-sh, in float64: the harmonics of two pages, blended, and packed as they are. */
export function morphSh(
  first: PackedHarmonics,
  second: PackedHarmonics,
  count: number,
  amount: number,
): PackedHarmonics {
  const { degree, precision, wordsPerSplat } = first;
  const words = new Uint32Array(count * wordsPerSplat);
  const width = coefficientsPerSplat(degree);
  const [a, b] = [new Float64Array(width), new Float64Array(width)];
  for (let i = 0; i < count; i++) {
    readCoefficients(first, i, a);
    readCoefficients(second, i, b);
    const blended = a.map((value, k) => value * (1 - amount) + b[k] * amount);
    packCoefficients(degree, precision, blended, words, i * wordsPerSplat);
  }
  return { degree, precision, wordsPerSplat, words };
}
