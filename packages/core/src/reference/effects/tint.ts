import type { Vec3 } from '../../math/mat4.ts';
import type { EffectTwin } from './effect-twin.ts';

export function tintTwin(tint: Vec3): EffectTwin {
  return { changeColor: (color) => [color[0] * tint[0], color[1] * tint[1], color[2] * tint[2]] };
}
