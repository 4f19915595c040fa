import type { Vec3 } from '../../../data/math/mat4.ts';
import type { EffectReference } from '../../../reference/effects/effect-reference.ts';

export const example: Vec3 = [1, 0.4, 0.8];

export function reference(tint: Vec3): EffectReference {
  return { changeColor: (color) => [color[0] * tint[0], color[1] * tint[1], color[2] * tint[2]] };
}
