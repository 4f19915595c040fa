import type { EffectUse } from '../effects/effect.ts';
import { CLOUD_EFFECTS } from '../effects/effects.ts';
import { antialias, brightness, opacity, tint } from '../effects/index.ts';

/** Uses of every effect in CLOUD_EFFECTS that change a picture of a cloud within ±1 of the origin. */
export const EFFECT_EXAMPLES: readonly EffectUse[] = [
  opacity(0.6),
  antialias(),
  brightness(1.8),
  tint([1, 0.4, 0.8]),
];

for (const { name } of CLOUD_EFFECTS) {
  if (!EFFECT_EXAMPLES.some(({ effect }) => effect.name === name))
    throw new RangeError(`The effect ${name} has no example: it would go untested.`);
}
