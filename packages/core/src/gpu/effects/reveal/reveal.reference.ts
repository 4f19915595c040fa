import { linearPart, transform3 } from '../../../data/math/mat4.ts';
import { edgeFade } from '../../../reference/effects/edge-fade.ts';
import type { EffectReference } from '../../../reference/effects/effect-reference.ts';
import { worldPosition } from '../../../reference/effects/world-position.ts';
import type { EffectPlace } from '../effect.ts';
import type { RevealOptions } from './reveal.ts';

export const example: RevealOptions = { from: [0.3, 0.1, 0.2], radius: 1, softEdge: 0.4 };

export function reference(options: RevealOptions, place: EffectPlace): EffectReference {
  const { from, radius, softEdge = 0, grow = true } = options;
  const { viewMatrix } = place;
  return {
    changeSplat(splat) {
      const position = worldPosition(splat.position, place);
      const offset =
        from === 'camera'
          ? transform3(linearPart(viewMatrix), position).map((v, axis) => v + viewMatrix[12 + axis])
          : position.map((v, axis) => v - from[axis]);
      const shown = edgeFade(radius - Math.hypot(...offset), softEdge);
      const growth = grow ? Math.log(shown) : 0;
      const [x, y, z] = splat.logScales;
      const logScales = [x + growth, y + growth, z + growth] as const;
      return { ...splat, opacity: splat.opacity * shown, logScales };
    },
  };
}
