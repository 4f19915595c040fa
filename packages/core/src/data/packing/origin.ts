import type { Vec3 } from '../math/mat4.ts';

/** Nearest origin: differences of float32 beyond are 0 or normal, which no device flushes to 0. */
const NEAREST = 2 ** -100;

/**
 * The point that positions within these bounds are stored relative to: 0 on an axis unless the
 * bounds lie so far out that float32 would lose precision there, that is unless |centre| > 4 · half
 * the bounds' largest side; then the centre, as a float32.
 *
 * Most files thus keep their coordinates as they are. Where an origin is taken from float32
 * coordinates, all lie within a quarter of it, so `p − origin` is exact in float32 (Sterbenz) and
 * adding it again restores every bit.
 */
export function chooseOrigin(min: Vec3, max: Vec3): Vec3 {
  const halfExtent = Math.max(max[0] - min[0], max[1] - min[1], max[2] - min[2]) / 2;
  const originOf = (axis: number) => {
    const centre = (min[axis] + max[axis]) / 2;
    const isFar = Math.abs(centre) > 4 * halfExtent && Math.abs(centre) > NEAREST;
    return isFar ? Math.fround(centre) : 0;
  };
  return [originOf(0), originOf(1), originOf(2)];
}
