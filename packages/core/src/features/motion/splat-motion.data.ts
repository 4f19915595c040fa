import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import type { Vec3 } from '../../data/math/mat4.ts';
import type { DropReason } from '../../data/splats/splat-set.ts';

const { LEAST_ROTATION, MOST_ELAPSED } = SHADER_CONSTANTS;

/**
 * Layout of one splat's motion: index of each property's first value. Spacetime Gaussians (Li et al.,
 * CVPR 2024), with d = time − `time`:
 *
 *     opacity(d)  = opacity · exp(−(d / exp(logDuration))²)
 *     position(d) = position + velocity · d + acceleration · d² + jerk · d³
 *     rotation(d) = normalize(rotation + turn · d)
 *
 * The rotation need not be a unit; if its turn cancels it, it is the identity.
 */
export const MOTION_SLOT = {
  /** Time at which the splat is as opaque as trained, and at its trained place. */
  time: 0,
  /** Natural logarithm of the time in which the opacity falls to 1/e. */
  logDuration: 1,
  /** x, y, z in scene units per unit of time. */
  velocity: 2,
  /** x, y, z per squared unit of time; not halved. */
  acceleration: 5,
  /** x, y, z per cubed unit of time; not divided by 6. */
  jerk: 8,
  /** w, x, y, z, added to the quaternion per unit of time. */
  turn: 11,
} as const;

/** Values of one splat's motion. */
export const MOTION_VALUES = 15;

/** Motions with a value beyond this are dropped: float32 has to hold products of four of them. */
export const MOST_MOTION = 1e12;
/** Shortest duration: its inverse, squared, is in float32's range. */
const LEAST_DURATION = 1e-18;

/** Why one splat's motion cannot be drawn; undefined if it can. */
export function reasonToDropMotion(motion: Float64Array | Float32Array): DropReason | undefined {
  return motion.some((value) => !(Math.abs(value) <= MOST_MOTION)) ? 'non-finite-motion' : undefined;
}

/** Time in which a splat's opacity falls to 1/e. */
export function durationOf(logDuration: number): number {
  return Math.max(LEAST_DURATION, Math.exp(logDuration));
}

/** Log duration of a splat that is always there: too long for any time to matter. */
const ENDLESS_LOG_DURATION = 80;

/** Returns the motion of `count` splats that stand still and are always there. */
export function stillMotion(count: number): Float32Array {
  const motion = new Float32Array(count * MOTION_VALUES);
  for (let i = 0; i < count; i++) motion[i * MOTION_VALUES + MOTION_SLOT.logDuration] = ENDLESS_LOG_DURATION;
  return motion;
}

/** How one splat differs at a time from the splat as trained. */
export interface MotionAt {
  /** Added to the position. */
  readonly displacement: Vec3;
  /** Factor of the opacity, 0…1. */
  readonly share: number;
  /** Added to the quaternion as trained. */
  readonly turn: readonly [number, number, number, number];
}

/** Splats move no further than after MOST_ELAPSED: the third power would leave float32's range. */
export const clampElapsed = (elapsed: number) => Math.max(-MOST_ELAPSED, Math.min(MOST_ELAPSED, elapsed));

/** Displacement along one axis after `t`, by velocity, acceleration and jerk. */
export const displacementAfter = (t: number, v: number, a: number, j: number) => t * (v + t * (a + t * j));

/** Evaluates a motion, in float64. @param at index in `motion` of the splat's first value. */
export function motionAt(motion: ArrayLike<number>, at: number, time: number): MotionAt {
  const away = time - motion[at + MOTION_SLOT.time];
  const elapsed = clampElapsed(away);
  const { velocity, acceleration, jerk } = MOTION_SLOT;
  const axis = (i: number) =>
    displacementAfter(
      elapsed,
      motion[at + velocity + i],
      motion[at + acceleration + i],
      motion[at + jerk + i],
    );
  const turn = (i: number) => elapsed * motion[at + MOTION_SLOT.turn + i];
  return {
    displacement: [axis(0), axis(1), axis(2)],
    share: Math.exp(-((away / durationOf(motion[at + MOTION_SLOT.logDuration])) ** 2)),
    turn: [turn(0), turn(1), turn(2), turn(3)],
  };
}

/**
 * Returns a rotation with what `motionAt` adds to it, not normalised; the identity if they cancel each
 * other. A rotation of zeros is the identity.
 */
export function turnedRotation(
  [w, x, y, z]: ArrayLike<number> & Iterable<number>,
  turn: MotionAt['turn'],
): [number, number, number, number] {
  const length = Math.hypot(w, x, y, z);
  const sum = [length > 0 ? w : 1, x, y, z].map((value, k) => value + turn[k]);
  const isLeft = Math.hypot(sum[0], sum[1], sum[2], sum[3]) >= LEAST_ROTATION * (length || 1);
  return isLeft ? (sum as [number, number, number, number]) : [1, 0, 0, 0];
}

/** First and last time of a moving scene. */
export type TimeRange = readonly [from: number, to: number];

/** Returns a time of the range: its first or last for times outside. */
export function timeWithin({ time, range: [from, to] }: { time: number; range: TimeRange }): number {
  return Math.max(from, Math.min(to, time));
}

/** Returns 0 to 1, the range of training, widened to the times of all splats. */
export function timeRangeOf(motion: Float32Array): TimeRange {
  let [from, to] = [0, 1];
  for (let at = MOTION_SLOT.time; at < motion.length; at += MOTION_VALUES) {
    from = Math.min(from, motion[at]);
    to = Math.max(to, motion[at]);
  }
  return [from, to];
}
