import { edgeFade } from '../../../reference/effects/edge-fade.ts';
import type { EffectReference } from '../../../reference/effects/effect-reference.ts';
import { decodeSrgb, encodeSrgb } from '../../../reference/srgb.ts';
import type { FogOptions } from './fog.ts';

export const example: FogOptions = { color: [0.5, 0.6, 0.8], near: 0.5, far: 3 };

export function reference(options: FogOptions): EffectReference {
  return {
    changeColor([r, g, b], _splat, _index, centerView) {
      const hidden = hiddenAt(options, -centerView[2]);
      const fogged = (value: number, channel: 0 | 1 | 2) =>
        encodeSrgb(
          (1 - hidden) * decodeSrgb(Math.max(0, value)) + hidden * decodeSrgb(options.color[channel]),
        );
      return [fogged(r, 0), fogged(g, 1), fogged(b, 2)];
    },
  };
}

/** Share of a splat's light that fog replaces at a view depth. */
function hiddenAt(options: FogOptions, depthView: number): number {
  if ('density' in options) return 1 - Math.exp(-((options.density * depthView) ** 2));
  return edgeFade(depthView - options.near, options.far - options.near);
}
