import type { Bounds } from '../data/packing/packed-cloud.ts';
import { worldMatrices } from '../frame/plan/cloud-instances.ts';
import type { CloudInstance } from '../frame/plan/frame-request.ts';

/** Returns bounds of all clouds without their outermost splats, in world space; a point at 0 without splats. */
export function worldBounds(clouds: readonly CloudInstance[]): Bounds {
  const min: [number, number, number] = [Infinity, Infinity, Infinity];
  const max: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  const places = clouds.flatMap((instance) => worldMatrices(instance).map((m) => ({ ...instance, m })));
  for (const { cloud, m } of places) {
    if (cloud.count === 0) continue;
    const { robustBounds } = cloud;
    for (let corner = 0; corner < 8; corner++) {
      const [x, y, z] = [0, 1, 2].map((axis) =>
        corner & (1 << axis) ? robustBounds.max[axis] : robustBounds.min[axis],
      );
      for (const axis of [0, 1, 2] as const) {
        const at = m[axis] * x + m[4 + axis] * y + m[8 + axis] * z + m[12 + axis];
        min[axis] = Math.min(min[axis], at);
        max[axis] = Math.max(max[axis], at);
      }
    }
  }
  return min[0] <= max[0] ? { min, max } : { min: [0, 0, 0], max: [0, 0, 0] };
}
