import type { Camera } from '../camera/camera.ts';
import { orderedBits } from '../layout/depth-key.ts';
import { multiply4 } from '../math/mat4.ts';
import type { CloudPlan } from './cloud-plan.ts';

/**
 * Bounds the number of bits in which the depth keys of a frame can differ, from near, far and the clouds' bounds, which the
 * CPU knows. Depths within a factor of 2^k of each other differ in fewer than 23 + k bits (each power of two holds 2^23
 * floats), so most scenes need fewer passes than 32 bits would.
 *
 * @returns 16, 24, 27 or 32: the key widths that sorts are made for.
 */
export function keyBitsFor(
  camera: Camera,
  clouds: readonly Pick<CloudPlan, 'instance' | 'modelMatrix' | 'reach'>[],
): number {
  let farthest = Number.NEGATIVE_INFINITY;
  let nearest = Number.POSITIVE_INFINITY;
  for (const { instance, modelMatrix, reach } of clouds) {
    const { cloud } = instance;
    // A cloud without splats has no bounds.
    if (cloud.count === 0) continue;
    const modelView = multiply4(camera.viewMatrix, modelMatrix);
    const { origin, bounds } = cloud;
    const originDepth = -(
      modelView[2] * origin[0] +
      modelView[6] * origin[1] +
      modelView[10] * origin[2] +
      modelView[14]
    );
    let low = originDepth;
    let high = originDepth;
    let magnitude = Math.abs(originDepth);
    for (let axis = 0; axis < 3; axis++) {
      const row = -modelView[4 * axis + 2];
      const from = bounds.min[axis] - origin[axis];
      const to = bounds.max[axis] - origin[axis];
      low += Math.min(row * from, row * to);
      high += Math.max(row * from, row * to);
      magnitude += Math.abs(row) * Math.max(Math.abs(from), Math.abs(to));
    }
    const moved = reach.displacement * Math.hypot(modelView[2], modelView[6], modelView[10]);
    // The GPU's depths are float32, computed from float32 terms about the cloud's origin.
    const rounding = 1e-5 * magnitude;
    nearest = Math.min(nearest, low - moved - rounding);
    farthest = Math.max(farthest, high + moved + rounding);
  }
  nearest = Math.max(nearest, camera.near);
  farthest = Math.min(farthest, camera.far);
  if (!(farthest > nearest)) return 16;
  const range = orderedBits(farthest) - orderedBits(nearest);
  return [16, 24, 27].find((bits) => range < 2 ** bits) ?? 32;
}
