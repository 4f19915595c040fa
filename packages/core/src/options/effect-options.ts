import type { Vec3 } from '../data/math/mat4.ts';
import type { EffectFunction, EffectUse, SplatEffect } from '../gpu/effects/effect.ts';

/** Place and size of the drawn scene, world units: first values and ranges of options depend on it. */
export interface ScenePlace {
  readonly center: Vec3;
  readonly radius: number;
  /** View depth of the scene's middle in the current view. */
  readonly viewDepth: number;
}

/** sRGB, as style sheets write it: `#ffd8a8`. */
export type HexColor = `#${string}`;

/** Value of an option: a number, a word, a colour, or x, y and z. */
export type OptionValue = number | string | Vec3;
/** Values of all options of an effect, by name. */
export type OptionValues = Readonly<Record<string, OptionValue>>;

interface OptionFacts<Values> {
  readonly label: string;
  /** The option applies only if other options have these values; default: always. */
  readonly when?: Partial<Values>;
  /** A sentence of advice. */
  readonly note?: string;
}

/** A number in a range. */
export interface NumberOption<Values = OptionValues> extends OptionFacts<Values> {
  readonly kind: 'number';
  /** `units`: world units. */
  readonly unit: 'units' | 'per unit' | 'degrees' | 'stops' | 'percent';
  range(place: ScenePlace, values: Values): readonly [min: number, max: number];
  first(place: ScenePlace): number;
  /** Whether the end of the range stands for Infinity; default false. */
  readonly isEndless?: boolean;
  /** Name of the option whose number must stay larger; the one that is not being changed is adjusted. */
  readonly below?: keyof Values & string;
}

/** A colour in sRGB. */
export interface ColorOption<Values = OptionValues> extends OptionFacts<Values> {
  readonly kind: 'color';
  readonly first: HexColor;
}

/** One of several words. */
export interface ChoiceOption<Values = OptionValues, Word extends string = string>
  extends OptionFacts<Values> {
  readonly kind: 'choice';
  /** Label of each word, for people. The words do not depend on `values`; labels may. */
  choices(values: Values): Readonly<Record<Word, string>>;
  readonly first: Word;
}

/** x, y and z in world space. */
export interface VectorOption<Values = OptionValues> extends OptionFacts<Values> {
  readonly kind: 'vector';
  /** @param axis 0, 1 or 2. */
  range(place: ScenePlace, axis: number): readonly [min: number, max: number];
  first(place: ScenePlace): Vec3;
  /** Direction of length 1 that a point may only move along; null or undefined: it moves freely. */
  along?(values: Values): Vec3 | null;
}

/** The word `camera`, or a point in world space; its first value is the scene's middle. */
export interface OriginOption<Values = OptionValues> extends OptionFacts<Values> {
  readonly kind: 'origin';
}

/** Description of one option's control in a user interface. */
export type EffectOption<Values = OptionValues> =
  | NumberOption<Values>
  | ColorOption<Values>
  | ChoiceOption<Values>
  | VectorOption<Values>
  | OriginOption<Values>;

type OptionOf<Value, Values> = [Value] extends [number]
  ? NumberOption<Values>
  : [Value] extends [HexColor]
    ? ColorOption<Values>
    : [Value] extends [string]
      ? ChoiceOption<Values, Value>
      : [Value] extends [Vec3]
        ? VectorOption<Values>
        : OriginOption<Values>;

/** All options of one effect, for a user interface. */
export interface EffectOptions {
  readonly effect: SplatEffect;
  /** By name, in the order to show and to write them: each before the options that depend on it. */
  readonly options: Readonly<Record<string, EffectOption>>;
  /**
   * Makes a use of the effect.
   *
   * @param values one for each option.
   * @throws InvalidArgumentError for values that the effect cannot have.
   */
  use(values: OptionValues): EffectUse;
}

/**
 * Describes the options of an effect for a user interface.
 *
 * @param engineOptions returns the argument of the effect's function.
 */
export function effectOptions<Options, Values>(
  make: EffectFunction<Options>,
  options: { readonly [Name in keyof Values]: OptionOf<Values[Name], Values> },
  engineOptions: (values: Values) => Options & {},
): EffectOptions {
  return {
    effect: make.effect,
    options: options as unknown as EffectOptions['options'],
    use: (values) => make(engineOptions(values as Values)),
  };
}

/** Red, green and blue, 0…1. */
export function rgbOf(color: HexColor): Vec3 {
  const byte = (at: number) => Number.parseInt(color.slice(at, at + 2), 16) / 255;
  return [byte(1), byte(3), byte(5)];
}
