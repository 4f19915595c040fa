/**
 * What a user can choose of each effect: labels, units, ranges and defaults, for settings panels.
 *
 * @module
 */
import { EFFECTS } from '../gpu/effects/effects.ts';
import type { EffectOptions } from './effect-options.ts';

export { planeNormal, type VolumeValues } from '../gpu/effects/volumes/volumes.options.ts';
export type {
  ChoiceOption,
  ColorOption,
  EffectOption,
  EffectOptions,
  HexColor,
  NumberOption,
  OptionValue,
  OptionValues,
  OriginOption,
  ScenePlace,
  VectorOption,
} from './effect-options.ts';

const OPTIONS = import.meta.glob<EffectOptions>('../gpu/effects/*/*.options.ts', {
  eager: true,
  import: 'options',
});

/**
 * Options of effects for a user interface, by effect, in the order in which effects act. Effects
 * whose options are not set by hand are left out: `opacity`, a property of clouds, and `highlight`,
 * which needs a selection.
 */
export const EFFECT_OPTIONS: Readonly<Record<string, EffectOptions>> = Object.fromEntries(
  Object.values(EFFECTS).flatMap(({ effect: { name } }) => {
    const options = OPTIONS[`../gpu/effects/${name}/${name}.options.ts`];
    return options ? [[name, options]] : [];
  }),
);
