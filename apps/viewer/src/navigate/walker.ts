import type { Vec3 } from '../state/vec3.ts';
import { type Ground, PUSHING_PART } from './ground.ts';

/** Eye height above the ground, m. All lengths here are a person's, in metres. */
export const EYES_M = 1.6;
const CROWN_M = 1.7;
const RADIUS_M = 0.25;
/** The foot rests on the highest ground within this radius, so that it steps over gaps. */
const FOOT_RADIUS_M = 0.15;
/** Steps up to this height are climbed, and descended without falling. */
const STEP_M = 0.3;
const SPEED_M_PER_S = 2;
const FAST_FACTOR = 3;
const GRAVITY_M_PER_S2 = 9.81;
/** Speed for a jump half a metre high. */
const JUMP_M_PER_S = Math.sqrt(2 * GRAVITY_M_PER_S2 * 0.5);
/**
 * Substeps are shorter than the body's radius at any speed, so that the walker passes through no
 * wall.
 */
const SUBSTEP_S = 1 / 120;
/** Time constant with which the eyes follow a step up or down. */
const SMOOTHING_S = 0.08;
/** Sample points of the foot, in foot radii. */
const FOOT = [
  [0, 0],
  [1, 0],
  [-1, 0],
  [0, 1],
  [0, -1],
] as const;

/** Requested movement. */
export interface Walking {
  /** Direction along x and z, up to length 1. */
  readonly way: readonly [x: number, z: number];
  readonly isFast: boolean;
  readonly isJumping: boolean;
}

/** A person on the ground of a scene, y up. */
export class Walker {
  /** In scene units; all other lengths scale with it. */
  eyeHeight: number;
  readonly #ground: Ground;
  #feet: Vec3;
  #lastStood: Vec3;
  #isStanding = true;
  /** Upward speed, m/s. */
  #speed = 0;
  /** Height of the eyes above their final position. */
  #lag: number;
  /** Eye position before the last substep. */
  #before: Vec3;
  #restS = 0;

  /** @param lag initial height of the eyes above their final position. */
  constructor(ground: Ground, feet: Vec3, eyeHeight: number, lag = 0) {
    this.#ground = ground;
    this.#feet = feet;
    this.#lastStood = feet;
    this.eyeHeight = eyeHeight;
    this.#lag = lag;
    this.#before = this.#eyes;
  }

  /** Interpolated between the last two substeps, because frames take any time. */
  get eyes(): Vec3 {
    const part = this.#restS / SUBSTEP_S;
    const [from, to] = [this.#before, this.#eyes];
    const at = (axis: 0 | 1 | 2) => from[axis] + part * (to[axis] - from[axis]);
    return [at(0), at(1), at(2)];
  }

  /** Whether the eyes still move without input. */
  get isMoving(): boolean {
    const to = this.#eyes;
    return !this.#isStanding || this.#before.some((value, axis) => value !== to[axis]);
  }

  /**
   * Moves by `elapsedS`. Returns whether the walker fell off the scene and was put back to its last
   * footing.
   */
  advance(elapsedS: number, walking: Walking): boolean {
    let hasFallen = false;
    for (this.#restS += elapsedS; this.#restS >= SUBSTEP_S; this.#restS -= SUBSTEP_S) {
      this.#before = this.#eyes;
      this.#walk(walking);
      this.#stand(walking.isJumping);
      this.#lag *= Math.exp(-SUBSTEP_S / SMOOTHING_S);
      if (Math.abs(this.#lag) < 1e-4 * this.eyeHeight) this.#lag = 0;
      if (this.#feet[1] >= this.#ground.bounds.min[1] - this.eyeHeight) continue;
      hasFallen = true;
      this.#feet = this.#lastStood;
      this.#isStanding = true;
      this.#speed = 0;
      this.#before = this.#eyes;
    }
    return hasFallen;
  }

  get #eyes(): Vec3 {
    const [x, y, z] = this.#feet;
    return [x, y + this.eyeHeight + this.#lag, z];
  }

  get #metre(): number {
    return this.eyeHeight / EYES_M;
  }

  #walk({ way, isFast }: Walking): void {
    const [x, y, z] = this.#feet;
    const length = SPEED_M_PER_S * (isFast ? FAST_FACTOR : 1) * this.#metre * SUBSTEP_S;
    const clear = clearedAt(this.#ground, [x + length * way[0], y, z + length * way[1]], this.eyeHeight);
    if (clear) this.#feet = clear;
  }

  #stand(isJumping: boolean): void {
    const [x, y, z] = this.#feet;
    const metre = this.#metre;
    const ground = groundUnder(this.#ground, this.#feet, this.eyeHeight);
    if (this.#isStanding && isJumping) {
      this.#isStanding = false;
      this.#speed = JUMP_M_PER_S;
    }
    if (this.#isStanding && ground !== null && ground >= y - STEP_M * metre) {
      this.#land(ground);
      return;
    }
    this.#isStanding = false;
    this.#speed -= GRAVITY_M_PER_S2 * SUBSTEP_S;
    let next = y + this.#speed * metre * SUBSTEP_S;
    const ceiling = this.#ground.above(x, y + STEP_M * metre, z);
    if (this.#speed > 0 && ceiling !== null && next + CROWN_M * metre > ceiling) {
      this.#speed = 0;
      next = y;
    }
    this.#feet = [x, next, z];
    if (this.#speed <= 0 && ground !== null && ground >= next) this.#land(ground);
  }

  #land(ground: number): void {
    const [x, y, z] = this.#feet;
    // Steps reach the eyes smoothly.
    this.#lag += y - ground;
    this.#feet = [x, ground, z];
    this.#lastStood = this.#feet;
    this.#isStanding = true;
    this.#speed = 0;
  }
}

/**
 * Where a person stands after coming down at `x`, `z` from height `y`; null if there is no ground.
 */
export function standingPlace(ground: Ground, [x, y, z]: Vec3, eyeHeight: number): Vec3 | null {
  const below = ground.below(x, y, z);
  const clear = below === null ? null : clearedAt(ground, [x, below, z], eyeHeight);
  const height = clear && groundUnder(ground, clear, eyeHeight);
  return clear && height !== null ? [clear[0], height, clear[2]] : null;
}

/** The position nearest to `feet` at which the body is clear of walls; null if there is no room. */
function clearedAt(ground: Ground, [x, y, z]: Vec3, eyeHeight: number): Vec3 | null {
  const metre = eyeHeight / EYES_M;
  const low = y + (STEP_M + PUSHING_PART * RADIUS_M) * metre;
  const clear = ground.cleared(x, z, low, y + (CROWN_M - RADIUS_M) * metre, RADIUS_M * metre);
  return clear && [clear[0], y, clear[1]];
}

/** Height of the ground at or below `feet`, up to the height of a step. */
function groundUnder(ground: Ground, [x, y, z]: Vec3, eyeHeight: number): number | null {
  const metre = eyeHeight / EYES_M;
  const heights = FOOT.map(([byX, byZ]) => {
    const radius = FOOT_RADIUS_M * metre;
    return ground.below(x + radius * byX, y + STEP_M * metre, z + radius * byZ) ?? -Infinity;
  });
  const highest = Math.max(...heights);
  return highest > -Infinity ? highest : null;
}
