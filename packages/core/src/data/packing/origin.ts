import type { Vec3 } from '../math/mat4.ts';
import { bulkOf, PositionSample } from './position-sample.ts';

/** Nearest origin: differences of float32 beyond are 0 or normal, which no device flushes to 0. */
const NEAREST = 2 ** -100;
/** An origin is worth it beyond so many times the distance within which the bulk lies: 4 bits of 24. */
const BULK_REACHES = 16;
/** Part of the sample that is the bulk. */
const BULK = { wide: 1 / 2, float32: 9 / 10 } as const;

/**
 * The point that positions are stored relative to: on each axis 0, or the median of the coordinates
 * if they lie so far out that float32 would lose precision there. They do if
 *
 * - |median| > 4 · half the largest side of the bounds; or
 * - |median| > 16 · the distance from the median within which the bulk lies: nine tenths of float32
 *   positions, more than half of wider ones. Strays do not count: failed points at 0, or outliers.
 *
 * The median is rounded to a multiple of a power of two, at most a quarter of the bulk's reach, so
 * that samples of the same scene, such as its pieces, mostly have one origin.
 *
 * Most files thus keep their coordinates as they are. `p − origin` is exact for float32 coordinates
 * from half to twice the origin (Sterbenz): for all in the first case, and for nine tenths or more in
 * the second. Only strays are rounded, to a float32 step of |p| or of |origin|, whichever is larger.
 * Positions of more precision are rounded in any case.
 *
 * @param axes sampled x, y and z in the scene's space, of equally many positions: see `PositionSample`.
 * @param bounds of all positions.
 * @param isWide whether positions have more precision than float32.
 */
export function chooseOrigin(
  axes: readonly ArrayLike<number>[],
  { min, max }: { readonly min: ArrayLike<number>; readonly max: ArrayLike<number> },
  isWide: boolean,
): Vec3 {
  const [{ length }] = axes;
  if (length === 0) return [0, 0, 0];
  const { medians, spread } = bulkOf(axes, isWide ? BULK.wide : BULK.float32);
  // The same for positions of both precisions: a file of doubles about an origin is read about it.
  const halfSpread = isWide ? spread : bulkOf(axes, BULK.wide).spread;
  const halfExtent = Math.max(max[0] - min[0], max[1] - min[1], max[2] - min[2]) / 2;
  const nearest = Math.max(NEAREST, Math.min(4 * halfExtent, BULK_REACHES * spread));
  const originOf = (axis: number) => {
    const origin = Math.fround(roundedTo(medians[axis], halfSpread / 4));
    // Strays at the other end of float32's range would be infinite.
    const isHeld = [min, max].every((corner) => Number.isFinite(Math.fround(corner[axis] - origin)));
    return Math.abs(medians[axis]) > nearest && isHeld ? origin : 0;
  };
  return [originOf(0), originOf(1), originOf(2)];
}

/** A value rounded to a multiple of the largest power of two that is no longer than `length`. */
function roundedTo(value: number, length: number): number {
  const step = 2 ** Math.floor(Math.log2(length));
  const rounded = Math.round(value / step) * step;
  return Number.isFinite(rounded) ? rounded : value;
}

/** The origin for splats of which these positions, float64 in the scene's space, are a sample; 3N. */
export function originOfSamples(positions: Float64Array): Vec3 {
  const count = positions.length / 3;
  const sample = new PositionSample();
  sample.addAll(positions, count);
  return chooseOrigin(sample.axes, boundsOf(sample.axes), true);
}

function boundsOf(axes: readonly Float64Array[]): { readonly min: number[]; readonly max: number[] } {
  const reduce = (pick: (a: number, b: number) => number) =>
    axes.map((values) => values.reduce(pick, values[0]));
  return { min: reduce((a, b) => Math.min(a, b)), max: reduce((a, b) => Math.max(a, b)) };
}
