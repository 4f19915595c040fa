import { type Camera, type Projection, projectionOf } from './camera.ts';

/** A camera that sees the same depths as another, from beside it. */
export interface CameraBeside {
  readonly camera: Camera;
  /** Its place in the other's view space, world units; both have the same depth. */
  readonly offset: readonly [x: number, y: number];
  readonly projection: Projection;
}

/** Entries of view matrices that are rounded to float32, as those of XR's poses, are no further apart. */
const TOLERANCE = 1e-6;
/** Difference in depth, as a share of `near`: a splat there may be drawn a little before or after. */
const DEPTH_TOLERANCE = 1e-3;

/**
 * Returns where `camera` is beside `other`: both look the same way, from the same depth and up to the same depths, as the eyes of most
 * headsets do. Splats then have the same order by depth for both. Null if they differ.
 */
export function besideOf(
  camera: Camera,
  other: Camera,
  widthPx: number,
  heightPx: number,
): CameraBeside | null {
  const { viewMatrix, near, far } = camera;
  // The same point of the world, in both view spaces.
  const moved = Array.from(viewMatrix, (value, i) => other.viewMatrix[i] - value);
  const [x, y, depth] = moved.splice(12, 3);
  const isBeside =
    near === other.near &&
    far === other.far &&
    camera.projectionMatrix[11] === other.projectionMatrix[11] &&
    Math.abs(depth) <= DEPTH_TOLERANCE * Math.abs(near) &&
    moved.every((difference) => Math.abs(difference) <= TOLERANCE);
  return isBeside ? { camera, offset: [x, y], projection: projectionOf(camera, widthPx, heightPx) } : null;
}
