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

/** Makes the twin of an effect with these options, for a cloud that stands there. */
export type TwinFunction = (options: never, place: EffectPlace) => EffectTwin;

/** Of the effects in CLOUD_EFFECTS, by name. */
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
 * Twins of `uses`, in their order.
 *
 * @param others twins of effects that are not this package's, by name.
 * @throws RangeError for an effect without a twin.
 */
export function twinsOf(
  uses: readonly EffectUse[],
  place: EffectPlace,
  others: Readonly<Record<string, TwinFunction>> = {},
): readonly EffectTwin[] {
  return uses.map(({ effect: { name }, options }) => {
    const twin = EFFECT_TWINS[name] ?? others[name];
    if (!twin) throw new RangeError(`There is no twin of the effect ${name}: give it in \`effectTwins\`.`);
    return twin(options as never, place);
  });
}
