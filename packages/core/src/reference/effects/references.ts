import type { EffectPlace, EffectUse } from '../../effects/effect.ts';
import { antialiasReference } from './antialias.ts';
import { brightnessReference } from './brightness.ts';
import { clipReference } from './clip.ts';
import type { EffectReference } from './effect-reference.ts';
import { fogReference } from './fog.ts';
import { highlightReference } from './highlight.ts';
import { opacityReference } from './opacity.ts';
import { revealReference } from './reveal.ts';
import { tintReference } from './tint.ts';

/** Makes the reference of an effect with these options, for a cloud at this place. */
export type ReferenceFunction = (options: never, place: EffectPlace) => EffectReference;

/** References of the effects in CLOUD_EFFECTS, by name. */
export const EFFECT_REFERENCES: Readonly<Record<string, ReferenceFunction>> = {
  clip: clipReference,
  reveal: revealReference,
  opacity: opacityReference,
  antialias: antialiasReference,
  brightness: brightnessReference,
  tint: tintReference,
  highlight: highlightReference,
  fog: fogReference,
};

/**
 * Makes the references of `uses`, in their order.
 *
 * @param others references of effects from outside this package, by name.
 * @throws RangeError for an effect without a reference.
 */
export function referencesOf(
  uses: readonly EffectUse[],
  place: EffectPlace,
  others: Readonly<Record<string, ReferenceFunction>> = {},
): readonly EffectReference[] {
  return uses.map(({ effect: { name }, options }) => {
    const reference = EFFECT_REFERENCES[name] ?? others[name];
    if (!reference)
      throw new RangeError(`The effect ${name} has no reference: pass one in \`effectReferences\`.`);
    return reference(options as never, place);
  });
}
