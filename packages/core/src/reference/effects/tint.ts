import type { Vec3 } from '../../math/mat4.ts';
import type { EffectReference } from './effect-reference.ts';

export function tintReference(tint: Vec3): EffectReference {
  return { changeColor: (color) => [color[0] * tint[0], color[1] * tint[1], color[2] * tint[2]] };
}
