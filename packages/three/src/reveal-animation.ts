import { InvalidArgumentError } from '@websplatter/core';
import { type EffectUse, type RevealOptions, reveal } from '@websplatter/core/effects';
import { type Box3, type Camera, Vector3 } from 'three/webgpu';

/** How a cloud appears by itself. */
export interface RevealAnimation extends Omit<RevealOptions, 'radius' | 'softEdge'> {
  /** From nothing to all of it, milliseconds, above 0. */
  readonly durationMs: number;
  /** As in `reveal`; default 0.3 times the radius that has been reached. */
  readonly softEdge?: number;
}

/** Width of the band that fades in, as a part of the radius, where the caller names none. */
const SOFT_PART = 0.3;

/**
 * The same animation, for who sets it later than it is given.
 *
 * @throws InvalidArgumentError for what is no place, width or time.
 */
export function checkedReveal(animation: RevealAnimation): RevealAnimation {
  const { durationMs, ...options } = animation;
  reveal({ ...options, radius: 0 });
  if (durationMs > 0 && durationMs < Number.POSITIVE_INFINITY) return animation;
  const message = `durationMs is ${durationMs}; it is how long a cloud takes to appear: milliseconds, finite and above 0.`;
  throw new InvalidArgumentError('durationMs', message);
}

/** A cloud that appears, from the first picture that it is in. */
export class Revealing {
  readonly animation: RevealAnimation;
  #beganAtMs: number | null = null;

  /** @throws InvalidArgumentError for what is no place, width or time. */
  constructor(animation: RevealAnimation) {
    this.animation = checkedReveal(animation);
  }

  /** The cloud has been drawn. */
  begin(nowMs: number): void {
    this.#beganAtMs ??= nowMs;
  }

  isOver(nowMs: number): boolean {
    return this.#progressAt(nowMs) >= 1;
  }

  /**
   * What is there of the cloud: its radius grows with the cube of time, so that what is near is seen to appear however far
   * the scene reaches, until the farthest corner of `bounds` has faded in.
   *
   * @param bounds of the cloud, world space.
   */
  useAt(nowMs: number, bounds: Box3, camera: Camera): EffectUse {
    const { from, softEdge, grow } = this.animation;
    if (this.isOver(nowMs)) return reveal({ from, radius: Number.POSITIVE_INFINITY });
    const start =
      from === 'camera' ? new Vector3().setFromMatrixPosition(camera.matrixWorld) : new Vector3(...from);
    // Of a cloud without splats the bounds are infinite, and inside out.
    const farthest = new Vector3().max(bounds.max.clone().sub(start)).max(start.sub(bounds.min)).length();
    const end = softEdge === undefined ? farthest / (1 - SOFT_PART) : farthest + softEdge;
    const radius = end * this.#progressAt(nowMs) ** 3;
    return reveal({ from, radius, softEdge: softEdge ?? SOFT_PART * radius, grow });
  }

  #progressAt(nowMs: number): number {
    return this.#beganAtMs === null ? 0 : (nowMs - this.#beganAtMs) / this.animation.durationMs;
  }
}
