import { type DistanceRange, dollied, type OrbitPose, orbited, panned } from '../state/orbit-pose.ts';
import type { Vec3 } from '../state/vec3.ts';
import { turnedInPlace } from './fly-pose.ts';

/** Positions of a gamepad's sticks and triggers after dead zones: −1…1, and 0…1 for triggers. */
export interface GamepadSticks {
  /** To the right and down. */
  readonly left: readonly [number, number];
  readonly right: readonly [number, number];
  readonly leftTrigger: number;
  readonly rightTrigger: number;
}

/** Fraction of a stick's range within which an untouched stick may rest. */
const DEAD_ZONE = 0.15;
const TURN_RADIANS_PER_S = 2;
/** Fractions of the image's height per second. */
const PAN_HEIGHTS_PER_S = 0.8;
/** Change of the distance's natural logarithm per second. */
const DOLLY_PER_S = 1.5;

/** Reads a gamepad with the standard mapping; null if nothing is touched. */
export function sticksOf({ axes, buttons }: Pick<Gamepad, 'axes' | 'buttons'>): GamepadSticks | null {
  const sticks = {
    left: withDeadZone(axes[0] ?? 0, axes[1] ?? 0),
    right: withDeadZone(axes[2] ?? 0, axes[3] ?? 0),
    leftTrigger: triggerOf(buttons[6]),
    rightTrigger: triggerOf(buttons[7]),
  };
  const all = [...sticks.left, ...sticks.right, sticks.leftTrigger, sticks.rightTrigger];
  return all.some((value) => value !== 0) ? sticks : null;
}

/**
 * A stick's position outside of its dead zone, which is round so that no direction is favoured. The
 * response is finer near the centre, for exact placement.
 */
export function withDeadZone(x: number, y: number): readonly [number, number] {
  const length = Math.hypot(x, y);
  if (length <= DEAD_ZONE) return [0, 0];
  const part = Math.min(1, (length - DEAD_ZONE) / (1 - DEAD_ZONE));
  return [(x / length) * part * part, (y / length) * part * part];
}

function triggerOf(button: GamepadButton | undefined): number {
  const value = button?.value ?? 0;
  return value <= DEAD_ZONE ? 0 : (value - DEAD_ZONE) / (1 - DEAD_ZONE);
}

/**
 * Moves around the scene: the right stick turns, the left one pans, the triggers dolly in and out.
 */
export function orbitedBy(
  pose: OrbitPose,
  { left, right, leftTrigger, rightTrigger }: GamepadSticks,
  elapsedS: number,
  fovYDegrees: number,
  range: DistanceRange,
): OrbitPose {
  const turn = TURN_RADIANS_PER_S * elapsedS;
  const pan = PAN_HEIGHTS_PER_S * elapsedS;
  const turned = orbited(pose, right[0] * turn, right[1] * turn);
  const moved = panned(turned, -left[0] * pan, -left[1] * pan, 1, fovYDegrees);
  return dollied(moved, Math.exp((leftTrigger - rightTrigger) * DOLLY_PER_S * elapsedS), range);
}

/** Looks around from within the scene with the right stick. */
export function lookedBy(pose: OrbitPose, { right }: GamepadSticks, elapsedS: number): OrbitPose {
  const turn = TURN_RADIANS_PER_S * elapsedS;
  return turnedInPlace(pose, -right[0] * turn, -right[1] * turn);
}

/**
 * Direction of movement within the scene: right, up and ahead. The left stick moves ahead and
 * sideways, triggers move up and down. Null if nothing is touched.
 */
export function directionOf({ left, leftTrigger, rightTrigger }: GamepadSticks): Vec3 | null {
  const direction: Vec3 = [left[0], rightTrigger - leftTrigger, -left[1]];
  return direction.some((value) => value !== 0) ? direction : null;
}
