import { type Box3, type OrthographicCamera, type PerspectiveCamera, Quaternion, Vector3 } from 'three';

export type FittedCamera = PerspectiveCamera | OrthographicCamera;

/** Near plane, in parts of the distance to the middle: as near as depths of 24 bits bear. */
const NEAREST_PART = 1 / 1000;

/**
 * Moves `camera` such that `box` fills the image up to `margin`, seen from the direction that it
 * looks in now. Sets near and far so that nothing of the box is cut off.
 *
 * @param box world space; nothing happens if it is empty.
 * @param margin extent of the image divided by the extent of the box; 1: no margin.
 * @param spared box in front of the far plane; default `box`.
 */
export function fitCamera(camera: FittedCamera, box: Box3, margin: number, spared = box): void {
  if (box.isEmpty()) return;
  camera.updateWorldMatrix(true, false);
  const turn = camera.getWorldQuaternion(new Quaternion());
  const center = box.getCenter(new Vector3());
  const back = turn.clone().invert();
  const corners = cornersOf(box).map((corner) => corner.sub(center).applyQuaternion(back));
  const distance = isPerspective(camera)
    ? perspectiveDistance(camera, corners, margin)
    : orthographicDistance(camera, corners, margin);
  const place = new Vector3(0, 0, distance).applyQuaternion(turn).add(center);
  camera.parent?.worldToLocal(place);
  camera.position.copy(place);
  const reach = Math.max(...corners.map((corner) => corner.length()));
  const farthest = Math.max(...cornersOf(spared).map((corner) => corner.distanceTo(center)));
  camera.near = Math.min(camera.near, Math.max(distance - reach, distance * NEAREST_PART));
  camera.far = Math.max(camera.far, distance + 2 * Math.max(reach, farthest));
  camera.updateProjectionMatrix();
  camera.updateMatrixWorld();
}

function cornersOf({ min, max }: Box3): Vector3[] {
  return Array.from(
    { length: 8 },
    (_, i) => new Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z),
  );
}

function isPerspective(camera: FittedCamera): camera is PerspectiveCamera {
  return (camera as PerspectiveCamera).isPerspectiveCamera;
}

/** The least distance from the middle at which all corners are in the image. */
function perspectiveDistance(camera: PerspectiveCamera, corners: readonly Vector3[], margin: number): number {
  const tangentY = Math.tan((camera.getEffectiveFOV() * Math.PI) / 360) / margin;
  const tangentX = tangentY * camera.aspect;
  const distances = corners.map(
    ({ x, y, z }) => z + Math.max(Math.abs(x) / tangentX, Math.abs(y) / tangentY),
  );
  return Math.max(...distances) || 1;
}

/** Sets the zoom that fits all corners into the image; returns a distance with all in front. */
function orthographicDistance(
  camera: OrthographicCamera,
  corners: readonly Vector3[],
  margin: number,
): number {
  const halfX = Math.max(...corners.map(({ x }) => Math.abs(x))) * margin;
  const halfY = Math.max(...corners.map(({ y }) => Math.abs(y))) * margin;
  const width = Math.abs(camera.right - camera.left) / 2;
  const height = Math.abs(camera.top - camera.bottom) / 2;
  const zoom = Math.min(width / halfX, height / halfY);
  if (zoom > 0 && zoom < Number.POSITIVE_INFINITY) camera.zoom = zoom;
  return 2 * Math.max(...corners.map((corner) => corner.length())) || 1;
}
