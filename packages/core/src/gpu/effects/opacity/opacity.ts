import { effectFunction } from '../effect.ts';
import { EFFECT_LIST } from '../effect-list.ts';
import { checkRange } from '../option-checks.ts';
import wgsl from './opacity.wgsl?raw';

/**
 * Multiplies every splat's opacity by a factor, 0…1.
 *
 * @example
 * const clouds = [{ cloud, effects: [opacity(0.5)] }];
 */
export const opacity = /* @__PURE__ */ effectFunction<number, { factor: 'f32' }>({
  ...EFFECT_LIST.opacity,
  wgsl,
  fields: { factor: 'f32' },
  check(factor) {
    checkRange('opacity', factor, 1, 'a factor of every splat’s opacity');
  },
  calledFor: (factor) =>
    factor === 1 ? null : `the cloud is drawn at ${Number((100 * factor).toFixed(1))} %`,
  valuesAt: (factor) => ({ factor }),
});
