import type { EffectPlace, EffectUse } from '../../effects/effect.ts';
import { antialiasTwin } from './antialias.ts';
import { brightnessTwin } from './brightness.ts';
import { clipTwin } from './clip.ts';
import type { EffectTwin } from './effect-twin.ts';
import { fogTwin } from './fog.ts';
import { highlightTwin } from './highlight.ts';
import { opacityTwin } from './opacity.ts';
import { revealTwin } from './reveal.ts';
import { tintTwin } from './tint.ts';

/** Makes the twin of an effect with these options, for a cloud at this place. */
export type TwinFunction = (options: never, place: EffectPlace) => EffectTwin;

/** Twins of the effects in CLOUD_EFFECTS, by name. */
export const EFFECT_TWINS: Readonly<Record<string, TwinFunction>> = {
  clip: clipTwin,
  reveal: revealTwin,
  opacity: opacityTwin,
  antialias: antialiasTwin,
  brightness: brightnessTwin,
  tint: tintTwin,
  highlight: highlightTwin,
  fog: fogTwin,
};

/**
 * Makes the twins of `uses`, in their order.
 *
 * @param others twins of effects from outside this package, by name.
 * @throws RangeError for an effect without a twin.
 */
export function twinsOf(
  uses: readonly EffectUse[],
  place: EffectPlace,
  others: Readonly<Record<string, TwinFunction>> = {},
): readonly EffectTwin[] {
  return uses.map(({ effect: { name }, options }) => {
    const twin = EFFECT_TWINS[name] ?? others[name];
    if (!twin) throw new RangeError(`The effect ${name} has no twin: pass one in \`effectTwins\`.`);
    return twin(options as never, place);
  });
}
