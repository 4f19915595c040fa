import { wrongArgument } from '../../../data/given.ts';
import { defineEffect } from '../effect.ts';
import wgsl from './antialias.wgsl?raw';

/**
 * Multiplies every splat's opacity by √(det Σ / det Σ′), where Σ is its covariance on the screen
 * and Σ′ is Σ with the dilation that it is drawn with: splats thinner than a pixel become fainter,
 * not only wider. Scenes trained with antialiasing (Mip-Splatting, gsplat's `antialiased`) expect
 * it; others become fainter than they were trained to be. It is on automatically for clouds whose
 * file says that they were trained so, unless `antialias(false)` is among their effects.
 *
 * @example
 * // Off, for a scene whose file asks for it.
 * const clouds = [{ cloud, effects: [antialias(false)] }];
 */
export const antialias = /* @__PURE__ */ defineEffect<boolean | undefined>({
  name: 'antialias',
  label: 'Antialiasing',
  about: 'Makes splats thinner than a pixel fainter, by the factor that they are drawn wider.',
  hooks: { opacity: 'compensateDilation' },
  wgsl,
  check(isOn = true) {
    if (typeof isOn !== 'boolean') throw wrongArgument('antialias', isOn, 'true or false');
  },
  calledFor: (isOn = true) => (isOn ? 'scenes trained with antialiasing expect it' : null),
});
