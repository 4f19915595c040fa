import { InvalidArgumentError } from '@websplatter/core';
import { type RevealOptions, reveal } from '@websplatter/core/effects';

/** How a cloud appears over time. */
export interface RevealAnimation extends Omit<RevealOptions, 'radius' | 'softEdge'> {
  /** Milliseconds until the whole cloud is visible, finite and above 0. */
  readonly durationMs: number;
  /** As in `reveal`; default 0.3 times the radius reached so far. */
  readonly softEdge?: number;
}

/** Whether `options` have a time, and so no radius. */
export function isAnimation(options: RevealAnimation | RevealOptions): options is RevealAnimation {
  return (options as RevealAnimation).durationMs !== undefined;
}

/**
 * Checks an animation that is set later, and returns it.
 *
 * @throws InvalidArgumentError for an invalid place, width or time, and for a radius, which only
 *   the effect `reveal` has.
 * @hidden Shared with the packages beside this one.
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
