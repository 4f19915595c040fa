import { decodeSrgb, encodeSrgb } from '../srgb.ts';
import type { EffectReference } from './effect-reference.ts';

export function brightnessReference(factor: number): EffectReference {
  const exposed = (value: number) => encodeSrgb(factor * decodeSrgb(value));
  return { changeColor: ([r, g, b]) => [exposed(r), exposed(g), exposed(b)] };
}
