import { InvalidArgumentError } from '@websplatter/core';
import { type EffectUse, type RevealOptions, reveal } from '@websplatter/core/effects';
import { type Box3, type Camera, Vector3 } from 'three/webgpu';

/** How a cloud appears over time. */
export interface RevealAnimation extends Omit<RevealOptions, 'radius' | 'softEdge'> {
  /** Milliseconds until the whole cloud is visible, finite and above 0. */
  readonly durationMs: number;
  /** As in `reveal`; default 0.3 times the radius reached so far. */
  readonly softEdge?: number;
}

/** Default width of the band that fades in, as a part of the radius. */
const SOFT_PART = 0.3;

/**
 * Checks an animation that is set later, and returns it.
 *
 * @throws InvalidArgumentError for an invalid place, width or time, and for a radius, which only the effect `reveal` has.
 */
export function checkedReveal(animation: RevealAnimation): RevealAnimation {
  const { durationMs, radius, ...options } = animation as RevealAnimation & Partial<RevealOptions>;
  if (radius !== undefined) {
    const message = 'reveal has both a radius and a durationMs. Leave one out.';
    throw new InvalidArgumentError('reveal', message);
  }
  reveal({ ...options, radius: 0 });
  if (Number.isFinite(durationMs) && durationMs > 0) return animation;
  const found = typeof durationMs === 'number' ? durationMs : `a ${typeof durationMs}`;
  const message = `durationMs is ${found}; it must be a finite number of milliseconds above 0.`;
  throw new InvalidArgumentError('durationMs', message);
}

/** A cloud that appears over time, from the first frame that draws it. */
export class Revealing {
  readonly animation: RevealAnimation;
  #beganAtMs: number | null = null;

  /** @throws InvalidArgumentError for an invalid place, width or time. */
  constructor(animation: RevealAnimation) {
    this.animation = checkedReveal(animation);
  }

  /** Starts the animation when the cloud is drawn for the first time; later calls change nothing. */
  begin(nowMs: number): void {
    this.#beganAtMs ??= nowMs;
  }

  isOver(nowMs: number): boolean {
    return this.#progressAt(nowMs) >= 1;
  }

  /**
   * Returns the effect that shows the part revealed by now. Its radius grows with the cube of time, so that near splats
   * appear visibly however far the scene reaches, until the farthest corner of `bounds` has faded in.
   *
   * @param bounds the cloud's, in world space.
   */
  useAt(nowMs: number, bounds: Box3, camera: Camera): EffectUse {
    const { from, softEdge, grow } = this.animation;
    if (this.isOver(nowMs)) return reveal({ from, radius: Number.POSITIVE_INFINITY });
    const start =
      from === 'camera' ? new Vector3().setFromMatrixPosition(camera.matrixWorld) : new Vector3(...from);
    // The bounds of a cloud without splats are infinite and inside out.
    const farthest = new Vector3().max(bounds.max.clone().sub(start)).max(start.sub(bounds.min)).length();
    const end = softEdge === undefined ? farthest / (1 - SOFT_PART) : farthest + softEdge;
    const radius = end * this.#progressAt(nowMs) ** 3;
    return reveal({ from, radius, softEdge: softEdge ?? SOFT_PART * radius, grow });
  }

  #progressAt(nowMs: number): number {
    return this.#beganAtMs === null ? 0 : (nowMs - this.#beganAtMs) / this.animation.durationMs;
  }
}
