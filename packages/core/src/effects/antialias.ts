import { effectShader } from '../shaders/link-shader.ts';
import { defineEffect } from './effect.ts';

/**
 * Multiplies every splat's opacity by √(det Σ / det Σ′), Σ its covariance on the screen and Σ′ the same with the dilation
 * that it is drawn with: what is thinner than a pixel becomes fainter and not only wider. Scenes trained with antialiasing
 * (Mip-Splatting, gsplat's `antialiased`) expect it; others become fainter than they were trained to be. Clouds whose file
 * says that they were trained so have it by themselves, unless `antialias(false)` is among their effects.
 */
export const antialias = /* @__PURE__ */ defineEffect<boolean | undefined>({
  name: 'antialias',
  label: 'Antialiasing',
  about: 'Makes splats thinner than a pixel fainter by as much as they are drawn wider.',
  hooks: { opacity: 'compensateDilation' },
  wgsl: effectShader('antialias'),
  calledFor: (isOn = true) =>
    isOn ? 'the cloud is drawn as scenes trained with antialiasing expect it' : null,
});
