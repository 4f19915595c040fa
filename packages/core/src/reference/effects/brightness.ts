import { decodeSrgb, encodeSrgb } from '../srgb.ts';
import type { EffectTwin } from './effect-twin.ts';

export function brightnessTwin(factor: number): EffectTwin {
  const exposed = (value: number) => encodeSrgb(factor * decodeSrgb(value));
  return { changeColor: ([r, g, b]) => [exposed(r), exposed(g), exposed(b)] };
}
