import type { Camera } from '../data/camera/camera.ts';
import type { Bounds } from '../data/packing/packed-cloud.ts';
import { pivotDepth, turnedAboutPivot } from './camera-pivot.ts';
import { checkCounts } from './check-options.ts';

/** Largest angle between a sampled view and the given one. */
const MAX_TURN = (35 * Math.PI) / 180;
/** Samples cycle through these: as far away as now, nearer, farther. */
const DISTANCE_FACTORS = [1, 0.65, 1.5] as const;
/** Turns by this angle never line up. */
const GOLDEN_ANGLE = Math.PI * (3 - Math.sqrt(5));

/**
 * Samples cameras around the scene in front of `camera`: the camera itself, then others that look at
 * the same point from other sides, from nearer and from farther. The same arguments give the same
 * cameras.
 *
 * @param bounds bounds of the scene, world space; for a single cloud without a model matrix
 * `cloud.robustBounds`.
 * @param count number of cameras, from 1.
 * @throws InvalidArgumentError if `count` is not a whole number of at least 1.
 * @example
 * const cameras = sampleCameras(camera, cloud.robustBounds, 6);
 * const table = await measureAccuracy(engine, { clouds: [{ cloud }], cameras, widthPx, heightPx });
 * const leastPsnrDb = table.points[0].error.psnrDb; // of the worst camera
 */
export function sampleCameras(camera: Camera, bounds: Bounds, count = 8): Camera[] {
  checkCounts({ count });
  const depth = pivotDepth(camera, bounds);
  return Array.from({ length: count }, (_, index) => {
    if (index === 0) return camera;
    const turn = MAX_TURN * Math.sqrt(index / (count - 1));
    const towards = index * GOLDEN_ANGLE;
    return turnedAboutPivot(camera, depth, {
      aboutY: turn * Math.cos(towards),
      aboutX: turn * Math.sin(towards),
      distanceFactor: DISTANCE_FACTORS[index % DISTANCE_FACTORS.length],
    });
  });
}
