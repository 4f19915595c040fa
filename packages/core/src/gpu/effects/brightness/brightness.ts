import { effectFunction } from '../effect.ts';
import { EFFECT_LIST } from '../effect-list.ts';
import { checkRange } from '../option-checks.ts';
import wgsl from './brightness.wgsl?raw';

/** Twenty stops: its product with any colour stays in float32's range. */
const LARGEST_FACTOR = 2 ** 20;

/**
 * Multiplies every splat's linear light by a factor, 0…2²⁰, as an exposure does: 2 is one stop
 * brighter, and 1 changes nothing. A grey tint, in contrast, multiplies sRGB-encoded values.
 *
 * @example
 * const clouds = [{ cloud, effects: [brightness(2)] }]; // One stop brighter.
 */
export const brightness = /* @__PURE__ */ effectFunction<number, { factor: 'f32' }>({
  ...EFFECT_LIST.brightness,
  wgsl,
  fields: { factor: 'f32' },
  check(factor) {
    checkRange('brightness', factor, LARGEST_FACTOR, 'a factor of linear light');
  },
  calledFor: (factor) => (factor === 1 ? null : `the cloud’s light is multiplied by ${factor}`),
  valuesAt: (factor) => ({ factor }),
});
