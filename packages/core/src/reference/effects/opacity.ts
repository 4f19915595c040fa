import type { EffectTwin } from './effect-twin.ts';

export function opacityTwin(factor: number): EffectTwin {
  return { changeSplat: (splat) => ({ ...splat, opacity: splat.opacity * factor }) };
}
