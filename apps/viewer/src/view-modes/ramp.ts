import type { Vec3 } from '../state/vec3.ts';

/**
 * Colours of a scale: a straight line between its end colours, in the space in which splats are
 * blended (sRGB-encoded). A pixel then has the colour of the mean of its splats' numbers; a curved
 * ramp would not.
 */
export interface Ramp {
  readonly low: RampEnd;
  readonly high: RampEnd;
}

export interface RampEnd {
  /** sRGB, 0…255. */
  readonly color: Vec3;
  /** The colour's name, for screen readers. */
  readonly name: string;
}

/** From plum to yellow. Lightness rises throughout, for people who see few hues. */
export const VALUE_RAMP: Ramp = {
  low: { color: [106, 8, 112], name: 'plum' },
  high: { color: [255, 228, 92], name: 'yellow' },
};

/** Near is bright, as if lit by a lamp at the camera. */
export const DEPTH_RAMP: Ramp = { low: VALUE_RAMP.high, high: VALUE_RAMP.low };

/** Colour of full overdraw; distinct from light and dark backgrounds. */
export const OVERDRAW_COLOR: RampEnd = { color: [235, 80, 24], name: 'orange' };

/** Marks places of unseen splats; unlike every colour of `VALUE_RAMP`. */
export const UNSEEN_COLOR: RampEnd = { color: [20, 105, 255], name: 'blue' };

/** As shaders expect it, 0…1. */
export function shaderColor({ color: [red, green, blue] }: RampEnd): Vec3 {
  return [red / 255, green / 255, blue / 255];
}
