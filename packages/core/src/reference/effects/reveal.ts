import type { EffectPlace } from '../../effects/effect.ts';
import type { RevealOptions } from '../../effects/reveal.ts';
import { linearPart, transform3 } from '../../math/mat4.ts';
import { edgeFade } from './edge-fade.ts';
import type { EffectReference } from './effect-reference.ts';
import { worldPosition } from './world-position.ts';

export function revealReference(options: RevealOptions, place: EffectPlace): EffectReference {
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
