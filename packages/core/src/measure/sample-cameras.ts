import type { Camera } from '../camera/camera.ts';
import { InvalidArgumentError } from '../errors.ts';
import { type Mat4, multiply4 } from '../math/mat4.ts';
import type { Bounds } from '../packing/packed-cloud.ts';

/** Largest angle between a sampled view and the given one. */
const MAX_TURN = (35 * Math.PI) / 180;
/** Samples cycle through these: as far away as now, nearer, farther. */
const DISTANCE_FACTORS = [1, 0.65, 1.5] as const;
/** Turns by this angle never line up. */
const GOLDEN_ANGLE = Math.PI * (3 - Math.sqrt(5));

/**
 * Samples cameras around the scene that `camera` sees: the camera itself, then others that look at the same place from other
 * sides, from nearer and from farther. The same arguments give the same cameras.
 *
 * @param bounds bounds of the scene, world space; for a single cloud without a model matrix `cloud.robustBounds`.
 * @param count number of cameras, from 1.
 * @throws InvalidArgumentError if `count` is not a whole number of at least 1.
 */
export function sampleCameras(camera: Camera, bounds: Bounds, count = 8): Camera[] {
  if (!(Number.isInteger(count) && count >= 1))
    throw new InvalidArgumentError('count', `count is ${count}; it must be a whole number of at least 1.`);
  const depth = pivotDepth(camera, bounds);
  return Array.from({ length: count }, (_, index) => {
    if (index === 0) return camera;
    const turn = MAX_TURN * Math.sqrt(index / (count - 1));
    const towards = index * GOLDEN_ANGLE;
    // In view space: move to the pivot, turn there, and move back by another distance.
    const there = alongView(depth);
    const turned = multiply4(rotation(turn * Math.cos(towards), turn * Math.sin(towards)), there);
    const factor = DISTANCE_FACTORS[index % DISTANCE_FACTORS.length];
    const back = multiply4(alongView(-depth * factor), turned);
    return { ...camera, viewMatrix: multiply4(back, camera.viewMatrix) };
  });
}

/** View depth of the pivot: the middle of the bounds, but never nearer than a fifth of their extent. */
function pivotDepth({ viewMatrix: v, near }: Camera, { min, max }: Bounds): number {
  const middle = [0, 1, 2].map((axis) => (min[axis] + max[axis]) / 2);
  const extent = Math.hypot(...[0, 1, 2].map((axis) => max[axis] - min[axis]));
  const depth = -(v[2] * middle[0] + v[6] * middle[1] + v[10] * middle[2] + v[14]);
  return Math.max(depth, extent / 5, 2 * near);
}

/** Moves by `depth` along the view's z axis. */
function alongView(depth: number): Mat4 {
  return Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, depth, 1);
}

/** Rotates about the image's y axis, then about its x axis; radians. */
function rotation(aboutY: number, aboutX: number): Mat4 {
  const [cy, sy, cx, sx] = [Math.cos(aboutY), Math.sin(aboutY), Math.cos(aboutX), Math.sin(aboutX)];
  const yaw = Float64Array.of(cy, 0, -sy, 0, 0, 1, 0, 0, sy, 0, cy, 0, 0, 0, 0, 1);
  const pitch = Float64Array.of(1, 0, 0, 0, 0, cx, sx, 0, 0, -sx, cx, 0, 0, 0, 0, 1);
  return multiply4(pitch, yaw);
}
