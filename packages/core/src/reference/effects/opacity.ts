import type { EffectReference } from './effect-reference.ts';

export function opacityReference(factor: number): EffectReference {
  return { changeSplat: (splat) => ({ ...splat, opacity: splat.opacity * factor }) };
}
