import { type ClipOptions, clip, type EffectUse } from '@websplatter/core/effects';
import type { RequestedEffects } from '../state/requested-effects.ts';

/**
 * What all panels together ask for. Clip volumes of several panels cut together; of any other effect that several ask for, the
 * panel acts that stands last in `EFFECT_OWNERS`.
 */
export function joinedEffects(requested: RequestedEffects): readonly EffectUse[] {
  const byName = new Map<string, EffectUse>();
  for (const use of Object.values(requested).flat()) {
    const { name } = use.effect;
    const before = byName.get(name);
    byName.set(name, before && use.effect === clip.effect ? joinedClip(before, use) : use);
  }
  return [...byName.values()];
}

function joinedClip(...uses: readonly EffectUse[]): EffectUse {
  const options = uses.map((use) => use.options as ClipOptions);
  return clip({
    volumes: options.flatMap(({ volumes }) => volumes),
    softEdge: Math.max(...options.map(({ softEdge = 0 }) => softEdge)),
  });
}
