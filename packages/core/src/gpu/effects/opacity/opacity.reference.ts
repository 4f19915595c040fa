import type { EffectReference } from '../../../reference/effects/effect-reference.ts';

export const example = 0.6;

export function reference(factor: number): EffectReference {
  return { changeSplat: (splat) => ({ ...splat, opacity: splat.opacity * factor }) };
}
