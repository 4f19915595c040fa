import type { EffectReference } from '../../../reference/effects/effect-reference.ts';
import { decodeSrgb, encodeSrgb } from '../../../reference/srgb.ts';

export const example = 1.8;

export function reference(factor: number): EffectReference {
  const exposed = (value: number) => encodeSrgb(factor * decodeSrgb(value));
  return { changeColor: ([r, g, b]) => [exposed(r), exposed(g), exposed(b)] };
}
