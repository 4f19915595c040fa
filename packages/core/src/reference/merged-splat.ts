import { LEVEL_CONSTANTS } from '../data/layout/level-structs.ts';
import type { Vec3 } from '../data/math/mat4.ts';
import { rotationMatrix } from './covariance.ts';
import type { UnpackedSplat } from './packing.ts';

/** A Gaussian with a weight: a splat, or several that were merged. */
export interface Merged {
  readonly center: Vec3;
  /** Opacity times mean area. */
  readonly weight: number;
  /** xx, yy, zz, yz, xz, xy. */
  readonly covariance: readonly number[];
  readonly color: Vec3;
  /** Sums over splats: opacity times rim length, and opacity. */
  readonly sums: readonly [number, number];
}

const PLACES = [
  [0, 0],
  [1, 1],
  [2, 2],
  [1, 2],
  [0, 2],
  [0, 1],
] as const;
const COLOR_OF_DC = 0.28209479177387814;

/** Reference of shaders/lib/merged-splat.wgsl, in float64 and without units of a cell. */
export function meanArea([a, b, c]: readonly number[]): number {
  const mean = ((a * b) ** 1.6075 + (a * c) ** 1.6075 + (b * c) ** 1.6075) / 3;
  return mean ** (1 / 1.6075);
}

export function rimLength(axes: readonly number[]): number {
  const longest = Math.max(...axes);
  return longest > 0 ? Math.max(0, longest - meanArea(axes) / longest) : 0;
}

/** `sums` of a splat that is a blob itself. */
export function mergedOf(splat: UnpackedSplat, sums?: readonly [number, number]): Merged {
  const rotation = rotationMatrix(...splat.rotation);
  const column = (axis: number) => [0, 1, 2].map((row) => rotation[3 * row + axis] * splat.scale[axis]);
  const axes = [column(0), column(1), column(2)];
  return {
    center: splat.position,
    weight: Math.max(splat.opacity, 1e-6) * meanArea(splat.scale),
    covariance: PLACES.map(([i, j]) => axes.reduce((sum, axis) => sum + axis[i] * axis[j], 0)),
    color: splat.colorDc,
    sums: sums ?? [splat.opacity * rimLength(splat.scale), splat.opacity],
  };
}

export function mergeCost(a: Merged, b: Merged): number {
  const weight = a.weight + b.weight;
  const share = a.weight / weight;
  const moved = share * (1 - share);
  const distance2 = squaredDistance(a.center, b.center);
  const contrast2 = COLOR_OF_DC ** 2 * squaredDistance(a.color, b.color);
  const traceOf = ({ covariance: [xx, yy, zz] }: Merged) => xx + yy + zz;
  const trace = share * traceOf(a) + (1 - share) * traceOf(b) + moved * distance2;
  return 4 * Math.PI * weight * moved * (distance2 + trace * contrast2);
}

export function merge(a: Merged, b: Merged): Merged {
  const weight = a.weight + b.weight;
  const share = a.weight / weight;
  const mix = (x: number, y: number) => share * x + (1 - share) * y;
  const mixed = (x: readonly number[], y: readonly number[]) => x.map((each, i) => mix(each, y[i]));
  const apart = a.center.map((each, i) => each - b.center[i]);
  const moved = share * (1 - share);
  return {
    center: mixed(a.center, b.center) as unknown as Vec3,
    weight,
    covariance: PLACES.map(
      ([i, j], k) => mix(a.covariance[k], b.covariance[k]) + moved * apart[i] * apart[j],
    ),
    color: mixed(a.color, b.color) as unknown as Vec3,
    sums: [a.sums[0] + b.sums[0], a.sums[1] + b.sums[1]],
  };
}

/** Opacity of a blob whose half axes are `axes`: above 1 where splats lie on top of each other. */
export function blobOpacity({ weight }: Pick<Merged, 'weight'>, axes: readonly number[]): number {
  return Math.min(weight / meanArea(axes), LEVEL_CONSTANTS.MOST_OPACITY);
}

function squaredDistance(a: readonly number[], b: readonly number[]): number {
  return a.reduce((sum, each, i) => sum + (each - b[i]) ** 2, 0);
}
