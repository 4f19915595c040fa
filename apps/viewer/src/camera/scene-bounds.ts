import type { Bounds, CloudInstance } from '@websplatter/core';
import type { Vec3 } from '../state/vec3.ts';

export interface Sphere {
  readonly center: Vec3;
  readonly radius: number;
  /** Half of each side of the bounding box from which the sphere was made, if any. */
  readonly halfSize?: Vec3;
}

/**
 * A bounding box of all clouds under their matrices.
 *
 * @param part which bounds of a cloud count.
 */
export function boundsOf(clouds: readonly CloudInstance[], part: 'bounds' | 'robustBounds'): Bounds {
  const min: [number, number, number] = [Infinity, Infinity, Infinity];
  const max: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  for (const { cloud, modelMatrix } of clouds) {
    // A cloud without splats has no bounds.
    if (cloud.count === 0) continue;
    for (const corner of cornersOf(cloud[part])) {
      const point = modelMatrix ? transformedPoint(modelMatrix, corner) : corner;
      for (const axis of [0, 1, 2]) {
        min[axis] = Math.min(min[axis], point[axis]);
        max[axis] = Math.max(max[axis], point[axis]);
      }
    }
  }
  return min.every(Number.isFinite) && max.every(Number.isFinite)
    ? { min, max }
    : { min: [0, 0, 0], max: [0, 0, 0] };
}

export function cornersOf({ min, max }: Bounds): Vec3[] {
  return Array.from({ length: 8 }, (_, i) => [
    i & 1 ? max[0] : min[0],
    i & 2 ? max[1] : min[1],
    i & 4 ? max[2] : min[2],
  ]);
}

/** Applies a column-major affine 4×4 matrix to `point`. */
export function transformedPoint(m: ArrayLike<number>, [x, y, z]: Vec3): Vec3 {
  const row = (i: number) => m[i] * x + m[4 + i] * y + m[8 + i] * z + m[12 + i];
  return [row(0), row(1), row(2)];
}

export function boundingSphere({ min, max }: Bounds): Sphere {
  const center: Vec3 = [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, (min[2] + max[2]) / 2];
  const halfSize: Vec3 = [(max[0] - min[0]) / 2, (max[1] - min[1]) / 2, (max[2] - min[2]) / 2];
  const radius = Math.hypot(...halfSize);
  // Splats in a single point have no extent, but the camera needs a distance.
  return radius > 0 && Number.isFinite(radius) ? { center, radius, halfSize } : { center, radius: 1 };
}
