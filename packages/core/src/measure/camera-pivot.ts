import type { Camera } from '../data/camera/camera.ts';
import { given, wrongArgument } from '../data/given.ts';
import { type Mat4, multiply4 } from '../data/math/mat4.ts';
import type { Bounds } from '../data/packing/packed-cloud.ts';
import type { CloudInstance } from '../frame/plan/frame-request.ts';
import { checkClouds } from './check-options.ts';
import { worldBounds } from './world-bounds.ts';

/** View depth of the pivot: the middle of the bounds, at least a fifth of their extent away. */
export function pivotDepth(camera: Camera, bounds: Bounds): number {
  const { viewMatrix: v, near } = given(camera, { viewMatrix: 'an object', near: 'a number' }, 'camera');
  const { min, max } = given(bounds, { min: 'a list', max: 'a list' }, 'bounds');
  const middle = [0, 1, 2].map((axis) => (min[axis] + max[axis]) / 2);
  const extent = Math.hypot(...[0, 1, 2].map((axis) => max[axis] - min[axis]));
  const depth = -(v[2] * middle[0] + v[6] * middle[1] + v[10] * middle[2] + v[14]);
  return Math.max(depth, extent / 5, 2 * near);
}

/**
 * Turns the scene in front of `camera` about the point of its line of sight at view depth `depth`:
 * about the image's y axis, then about its x axis, in radians. The camera ends up at
 * `distanceFactor` times its distance from that point.
 */
export function turnedAboutPivot(
  camera: Camera,
  depth: number,
  turn: { readonly aboutY: number; readonly aboutX?: number; readonly distanceFactor?: number },
): Camera {
  const { aboutY, aboutX = 0, distanceFactor = 1 } = turn;
  // In view space: move to the pivot, turn there, and move back.
  const turned = multiply4(rotation(aboutY, aboutX), alongView(depth));
  const back = multiply4(alongView(-depth * distanceFactor), turned);
  return { ...camera, viewMatrix: multiply4(back, camera.viewMatrix) };
}

/**
 * Moves a camera away from the scene in front of it, along its line of sight: to `distanceFactor`
 * times its distance from the point that `orbitCameras` go around.
 *
 * @throws InvalidArgumentError if `distanceFactor` is not a finite number above 0.
 * @example
 * const clouds = [{ cloud }];
 * const cameras = [1, 2, 4].map((factor) => cameraAtDistance(camera, clouds, factor));
 * const table = await measureAccuracy(engine, { clouds, cameras, widthPx, heightPx });
 */
export function cameraAtDistance(
  camera: Camera,
  clouds: readonly CloudInstance[],
  distanceFactor: number,
): Camera {
  checkClouds(clouds);
  if (!(Number.isFinite(distanceFactor) && distanceFactor > 0))
    throw wrongArgument('distanceFactor', distanceFactor, 'a finite number above 0');
  return turnedAboutPivot(camera, pivotDepth(camera, worldBounds(clouds)), { aboutY: 0, distanceFactor });
}

/** Moves by `depth` along the view's z axis. */
function alongView(depth: number): Mat4 {
  return Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, depth, 1);
}

function rotation(aboutY: number, aboutX: number): Mat4 {
  const [cy, sy, cx, sx] = [Math.cos(aboutY), Math.sin(aboutY), Math.cos(aboutX), Math.sin(aboutX)];
  const yaw = Float64Array.of(cy, 0, -sy, 0, 0, 1, 0, 0, sy, 0, cy, 0, 0, 0, 0, 1);
  const pitch = Float64Array.of(1, 0, 0, 0, 0, cx, sx, 0, 0, -sx, cx, 0, 0, 0, 0, 1);
  return multiply4(pitch, yaw);
}
