import { cameraAxes, lookAt, type OrbitPose, orbited } from '../state/orbit-pose.ts';
import { add, scale, subtract, type Vec3 } from '../state/vec3.ts';

/** Turns the camera in place; its distance to the target stays. */
export function turnedInPlace(pose: OrbitPose, azimuthBy: number, polarBy: number): OrbitPose {
  const turned = orbited(pose, azimuthBy, polarBy);
  const { back } = cameraAxes(turned);
  return { ...turned, target: subtract(lookAt(pose).position, scale(back, pose.distance)) };
}

/** Moves by `offset`: right, up in the world (not the image), and ahead along the line of sight. */
export function flown(pose: OrbitPose, [right, up, ahead]: Vec3): OrbitPose {
  const axes = cameraAxes(pose);
  const way = add(add(scale(axes.right, right), scale(pose.up, up)), scale(axes.back, -ahead));
  return { ...pose, target: add(pose.target, way) };
}

/**
 * Directions by key code, so that the keys lie together on every keyboard layout: right, up and
 * ahead.
 */
const DIRECTIONS: Readonly<Record<string, Vec3>> = {
  KeyD: [1, 0, 0],
  KeyA: [-1, 0, 0],
  KeyE: [0, 1, 0],
  Space: [0, 1, 0],
  KeyQ: [0, -1, 0],
  KeyW: [0, 0, 1],
  KeyS: [0, 0, -1],
  ArrowRight: [1, 0, 0],
  ArrowLeft: [-1, 0, 0],
  PageUp: [0, 1, 0],
  PageDown: [0, -1, 0],
  ArrowUp: [0, 0, 1],
  ArrowDown: [0, 0, -1],
};

/** Whether the key (`KeyboardEvent.code`) moves the camera in flight. */
export function isFlightKey(code: string): boolean {
  return Object.hasOwn(DIRECTIONS, code);
}

/** Direction of the held keys, of length 1; null if there are none or they cancel out. */
export function flightDirection(codes: Iterable<string>): Vec3 | null {
  let sum: Vec3 = [0, 0, 0];
  for (const code of codes) sum = add(sum, DIRECTIONS[code]);
  // Two keys for one direction are no faster than one.
  const clamped = sum.map(Math.sign) as unknown as Vec3;
  const length = Math.hypot(...clamped);
  return length > 0 ? scale(clamped, 1 / length) : null;
}
