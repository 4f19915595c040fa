import {
  EFFECT_OPTIONS,
  type EffectOption,
  type NumberOption,
  type OptionValue,
  type OptionValues,
  type ScenePlace,
} from '@websplatter/core/effect-options';
import type { EffectUse } from '@websplatter/core/effects';
import { roundedTo, stepFor } from '@websplatter/kit/nice-steps';
import type { EffectChoices } from './effects.ts';
import type { Vec3 } from './vec3.ts';

/** The options of an effect that have a meaning beside these values, with their names. */
export function optionsBeside(
  effect: string,
  values: OptionValues,
): readonly (readonly [name: string, option: EffectOption])[] {
  return Object.entries(EFFECT_OPTIONS[effect].options).filter(([, { when = {} }]) =>
    Object.entries(when).every(([name, value]) => values[name] === value),
  );
}

/** The effects that are switched on, as the engine takes them. */
export function chosenUses(choices: EffectChoices): readonly EffectUse[] {
  return Object.entries(EFFECT_OPTIONS).flatMap(([name, { use }]) => {
    const chosen = choices[name];
    return chosen?.isOn ? [use(chosen.values)] : [];
  });
}

/** First values of an effect: figures short enough to be read. */
export function firstValues(effect: string, place: ScenePlace): OptionValues {
  const options = Object.entries(EFFECT_OPTIONS[effect].options);
  return Object.fromEntries(options.map(([name, option]) => [name, firstValue(option, place)]));
}

function firstValue(option: EffectOption, place: ScenePlace): OptionValue {
  const { radius, viewDepth } = place;
  const rounded = ([x, y, z]: Vec3): Vec3 => {
    const step = stepFor(radius);
    return [roundedTo(x, step), roundedTo(y, step), roundedTo(z, step)];
  };
  switch (option.kind) {
    case 'number': {
      const length = option.unit === 'per unit' ? 1 / viewDepth : radius;
      return roundedTo(option.first(place), stepOf(option, length));
    }
    case 'origin':
      return rounded(place.center);
    case 'vector':
      return rounded(option.first(place));
    default:
      return option.first;
  }
}

/** How far apart the numbers of a range of this length are. */
export function stepOf({ unit }: Pick<NumberOption, 'unit'>, length: number): number {
  if (unit === 'degrees') return 1;
  return unit === 'stops' ? 0.1 : stepFor(length);
}
