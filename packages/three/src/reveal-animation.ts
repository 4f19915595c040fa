import { InvalidArgumentError } from '@websplatter/core';
import { type EffectUse, type RevealOptions, reveal } from '@websplatter/core/effects';
import { type Box3, type Camera, Vector3 } from 'three/webgpu';

/** How a cloud appears by itself. */
export interface RevealAnimation extends Omit<RevealOptions, 'radius'> {
  /** From nothing to all of it, milliseconds, above 0. */
  readonly durationMs: number;
}

/** Width of the band that fades in, as a part of the way that there is to go, where the caller names none. */
const SOFT_PART = 0.25;

/** A cloud that appears, from the first picture that it is in. */
export class Revealing {
  readonly animation: RevealAnimation;
  #beganAtMs: number | null = null;

  /** @throws InvalidArgumentError for what is no place, width or time. */
  constructor(animation: RevealAnimation) {
    const { durationMs, ...options } = animation;
    reveal({ ...options, radius: 0 });
    if (!(durationMs > 0 && durationMs < Number.POSITIVE_INFINITY)) {
      const message = `durationMs is ${durationMs}; it is the time that a cloud takes to appear: milliseconds, finite and above 0.`;
      throw new InvalidArgumentError('durationMs', message);
    }
    this.animation = animation;
  }

  /** The cloud has been drawn. */
  begin(nowMs: number): void {
    this.#beganAtMs ??= nowMs;
  }

  isOver(nowMs: number): boolean {
    return this.#progressAt(nowMs) >= 1;
  }

  /**
   * What is there of the cloud: its radius grows at an even pace, until the farthest corner of `bounds` has faded in.
   *
   * @param bounds of the cloud, world space.
   */
  useAt(nowMs: number, bounds: Box3, camera: Camera): EffectUse {
    const { from, softEdge, grow } = this.animation;
    const start =
      from === 'camera' ? new Vector3().setFromMatrixPosition(camera.matrixWorld) : new Vector3(...from);
    const [toMin, toMax] = [start.clone().sub(bounds.min), bounds.max.clone().sub(start)];
    const farthest = toMin.max(toMax).length();
    const band = softEdge ?? SOFT_PART * farthest;
    const radius = this.isOver(nowMs)
      ? Number.POSITIVE_INFINITY
      : this.#progressAt(nowMs) * (farthest + band);
    return reveal({ from, radius, softEdge: band, grow });
  }

  #progressAt(nowMs: number): number {
    return this.#beganAtMs === null ? 0 : (nowMs - this.#beganAtMs) / this.animation.durationMs;
  }
}
