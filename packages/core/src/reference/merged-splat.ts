import { LEVEL_CONSTANTS } from '../data/layout/level-structs.ts';
import type { Vec3 } from '../data/math/mat4.ts';
import { rotationMatrix } from './covariance.ts';
import type { ReferenceSplat } from './packing.ts';

/** A Gaussian with a weight: a splat, or several that were merged. */
export interface Merged {
  readonly center: Vec3;
  /** Area that it covers, over 2π, on average over directions. */
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

const GOLDEN = (1 + Math.sqrt(5)) / 2;
const DIRECTIONS: readonly Vec3[] = [-GOLDEN, GOLDEN].flatMap((long): Vec3[] => {
  const [a, b] = [1 / Math.hypot(1, GOLDEN), long / Math.hypot(1, GOLDEN)];
  return [
    [0, a, b],
    [a, b, 0],
    [b, 0, a],
  ];
});
const SERIES_START = 1 - Math.log(1.5) - 1 / 54;

/** Area that a stack covers, in areas of an opaque splat of its shape. */
function coverOf(opacity: number): number {
  const x = opacity + 0.5;
  return opacity <= 1 ? opacity : Math.log(x) + 1 / (24 * x * x) + SERIES_START;
}

/** The inverse of `coverOf`. */
function opacityOfCover(cover: number): number {
  if (cover <= 1) return cover;
  let [low, high] = [1, Math.exp(cover)];
  for (let step = 0; step < 100; step++) {
    const middle = (low + high) / 2;
    if (coverOf(middle) < cover) low = middle;
    else high = middle;
  }
  return low;
}

/** Area, over 2π, of a Gaussian seen along `n`, whose covariance is xx, yy, zz, yz, xz, xy. */
function footprint([xx, yy, zz, yz, xz, xy]: readonly number[], [x, y, z]: Vec3): number {
  const squared =
    x * x * (yy * zz - yz * yz) +
    y * y * (xx * zz - xz * xz) +
    z * z * (xx * yy - xy * xy) +
    2 * (y * z * (xy * xz - xx * yz) + x * z * (xy * yz - yy * xz) + x * y * (xz * yz - zz * xy));
  return Math.sqrt(Math.max(0, squared));
}

/** Mean over the directions of the footprint of a splat, which may be a needle or a disc. */
function meanFootprint({ rotation, scale: [a, b, c] }: Pick<ReferenceSplat, 'rotation' | 'scale'>): number {
  const r = rotationMatrix(...rotation);
  const along = (column: number, [x, y, z]: Vec3) => r[column] * x + r[3 + column] * y + r[6 + column] * z;
  const areas = DIRECTIONS.map((n) =>
    Math.hypot(b * c * along(0, n), a * c * along(1, n), a * b * along(2, n)),
  );
  return areas.reduce((sum, area) => sum + area) / DIRECTIONS.length;
}

/** `sums` of a splat that is a blob itself. */
export function mergedOf(splat: ReferenceSplat, sums?: readonly [number, number]): Merged {
  const rotation = rotationMatrix(...splat.rotation);
  const column = (axis: number) => [0, 1, 2].map((row) => rotation[3 * row + axis] * splat.scale[axis]);
  const axes = [column(0), column(1), column(2)];
  return {
    center: splat.position,
    weight: coverOf(Math.max(splat.opacity, 1e-6)) * meanFootprint(splat),
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
  const shapes2 = a.covariance.reduce(
    (sum, each, i) => sum + (i < 3 ? 1 : 2) * (each - b.covariance[i]) ** 2,
    0,
  );
  const shapes = Math.max(0, Math.sqrt(shapes2) - 1e-6 * trace);
  return 4 * Math.PI * weight * moved * (distance2 + 3 * trace * contrast2 + 0.25 * shapes);
}

/** Area that both cover, over 2π, on average over the directions. */
function overlapOf(a: Merged, b: Merged): number {
  const sum = a.covariance.map((each, i) => each + b.covariance[i]);
  const apart = a.center.map((each, i) => each - b.center[i]);
  const areas = [a, b].map(({ covariance, weight }) => {
    const seen = DIRECTIONS.map((n) => footprint(covariance, n));
    const mean = seen.reduce((total, each) => total + each) / DIRECTIONS.length;
    return seen.map((each) => (mean > 0 ? (weight * each) / mean : 0));
  });
  const overlaps = DIRECTIONS.map((n, i) => {
    const [ofA, ofB] = [areas[0][i], areas[1][i]];
    const both = footprint(sum, n);
    if (both === 0) return 0;
    const [x, y, z] = [0, 1, 2].map(
      (k) => n[(k + 1) % 3] * apart[(k + 2) % 3] - n[(k + 2) % 3] * apart[(k + 1) % 3],
    );
    const [xx, yy, zz, yz, xz, xy] = sum;
    const squared = xx * x * x + yy * y * y + zz * z * z + 2 * (yz * y * z + xz * x * z + xy * x * y);
    return Math.min(((ofA * ofB) / both) * Math.exp((-0.5 * squared) / both ** 2), ofA, ofB);
  });
  return overlaps.reduce((total, each) => total + each) / DIRECTIONS.length;
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
    weight: weight - overlapOf(a, b),
    covariance: PLACES.map(
      ([i, j], k) => mix(a.covariance[k], b.covariance[k]) + moved * apart[i] * apart[j],
    ),
    color: mixed(a.color, b.color) as unknown as Vec3,
    sums: [a.sums[0] + b.sums[0], a.sums[1] + b.sums[1]],
  };
}

/** Opacity of a blob of this shape: above 1 where splats lie on top of each other. */
export function blobOpacity(
  { weight }: Pick<Merged, 'weight'>,
  shape: Pick<ReferenceSplat, 'rotation' | 'scale'>,
): number {
  return Math.min(opacityOfCover(weight / meanFootprint(shape)), LEVEL_CONSTANTS.MOST_OPACITY);
}

function squaredDistance(a: readonly number[], b: readonly number[]): number {
  return a.reduce((sum, each, i) => sum + (each - b[i]) ** 2, 0);
}
