import type { EffectUse } from '../gpu/effects/effect.ts';
import { EFFECTS } from '../gpu/effects/effects.ts';

const REFERENCES = import.meta.glob<{ readonly example?: never }>('../gpu/effects/*/*.reference.ts', {
  eager: true,
});

/** A use of every effect that changes the image of a cloud within ±1 of the origin. */
export const EFFECT_EXAMPLES: readonly EffectUse[] = Object.values(EFFECTS).map((use) => {
  const { name } = use.effect;
  const { example } = REFERENCES[`../gpu/effects/${name}/${name}.reference.ts`];
  if (example === undefined) throw new RangeError(`The effect ${name} has no example: it would go untested.`);
  return use(example);
});
