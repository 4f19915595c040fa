import type { Vec3 } from '../../../data/math/mat4.ts';
import { effectFunction } from '../effect.ts';
import { EFFECT_LIST } from '../effect-list.ts';
import { checkVector } from '../option-checks.ts';
import wgsl from './tint.wgsl?raw';

/**
 * Multiplies every colour by red, green and blue, sRGB-encoded, 0 or more; no change at 1.
 *
 * @example
 * const clouds = [{ cloud, effects: [tint([1, 0.8, 0.6])] }];
 */
export const tint = /* @__PURE__ */ effectFunction<Vec3, { color: 'vec3f' }>({
  ...EFFECT_LIST.tint,
  wgsl,
  fields: { color: 'vec3f' },
  check(color) {
    checkVector('tint', color, 'a factor for red, green and blue', { isNonNegative: true });
  },
  calledFor: (color) =>
    color.every((value) => value === 1)
      ? null
      : `colours are multiplied by ${color.map(shortened).join(', ')}`,
  valuesAt: (color) => ({ color }),
});

/** Sliders and pickers of colours give fractions without an end. */
const shortened = (factor: number) => Number(factor.toPrecision(3));
