import { type ClipOptions, clip, type EffectUse } from '@websplatter/core/effects';
import { CLOUD_EFFECT_OWNERS, EFFECT_OWNERS, type RequestedEffects } from '../state/requested-effects.ts';

/**
 * Effects that all panels together request of a cloud. Clip volumes of several panels cut together;
 * of any other effect requested twice, the one whose panel is last in the lists of owners acts.
 * While a view mode gives splats colours of its own, only marks of a selection change them.
 *
 * @param cloudKey of `cloudKeys`.
 */
export function joinedEffects(requested: RequestedEffects, cloudKey: string): readonly EffectUse[] {
  const byName = new Map<string, EffectUse>();
  const own = requested['view-mode'];
  const isColored = own.some(({ effect }) => effect.hooks.color !== undefined);
  const uses = [
    ...EFFECT_OWNERS.flatMap((owner) => requested[owner]),
    ...CLOUD_EFFECT_OWNERS.flatMap((owner) => requested[owner].get(cloudKey) ?? []),
  ];
  for (const use of uses) {
    if (isColored && !own.includes(use) && recolorsAll(use)) continue;
    const { name } = use.effect;
    const before = byName.get(name);
    byName.set(name, before && use.effect === clip.effect ? joinedClip(before, use) : use);
  }
  return [...byName.values()];
}

function recolorsAll({ effect }: EffectUse): boolean {
  return effect.hooks.color !== undefined && !effect.takesSelection;
}

function joinedClip(...uses: readonly EffectUse[]): EffectUse {
  const options = uses.map((use) => use.options as ClipOptions);
  return clip({
    volumes: options.flatMap(({ volumes }) => volumes),
    softEdge: Math.max(...options.map(({ softEdge = 0 }) => softEdge)),
  });
}
