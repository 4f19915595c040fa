import type { Vec3 } from '../state/vec3.ts';

/**
 * Colours for the numbers of a scale: a straight line between those of its ends, in the space that
 * splats are blended in (sRGB-encoded). A pixel then has just the colour of the mean of its splats'
 * numbers, which no curved scale would give.
 */
export interface Ramp {
  readonly low: RampEnd;
  readonly high: RampEnd;
}

export interface RampEnd {
  /** sRGB, 0…255. */
  readonly color: Vec3;
  /** In words, for screen readers. */
  readonly name: string;
}

/** From plum to yellow: the lightness rises all the way, for people who see few hues. */
export const VALUE_RAMP: Ramp = {
  low: { color: [106, 8, 112], name: 'plum' },
  high: { color: [255, 228, 92], name: 'yellow' },
};

/** Near is bright, as by a lamp at the camera. */
export const DEPTH_RAMP: Ramp = { low: VALUE_RAMP.high, high: VALUE_RAMP.low };

/** Colour of full overdraw; distinct from light and dark backgrounds. */
export const OVERDRAW_COLOR: RampEnd = { color: [235, 80, 24], name: 'orange' };

/** Where splats are that are not seen; no colour between the ends of `VALUE_RAMP` is like it. */
export const UNSEEN_COLOR: RampEnd = { color: [20, 105, 255], name: 'blue' };

/** As shaders take it, 0…1. */
export function shaderColor({ color: [red, green, blue] }: RampEnd): Vec3 {
  return [red / 255, green / 255, blue / 255];
}
