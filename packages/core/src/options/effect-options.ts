import type { Vec3 } from '../data/math/mat4.ts';
import type { EffectFunction, EffectUse, SplatEffect } from '../gpu/effects/effect.ts';

/** Place and size of the drawn scene, which first values and ranges are scaled to. World units. */
export interface ScenePlace {
  readonly center: Vec3;
  readonly radius: number;
  /** Of the middle, in the view that is shown. */
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
  /** The option has a meaning only where others have these values; default: anywhere. */
  readonly when?: Partial<Values>;
  /** A sentence of advice. */
  readonly note?: string;
}

/** A number in a range. */
export interface NumberOption<Values = OptionValues> extends OptionFacts<Values> {
  readonly kind: 'number';
  /** `units`: of the world. */
  readonly unit: 'units' | 'per unit' | 'degrees' | 'stops';
  range(place: ScenePlace, values: Values): readonly [min: number, max: number];
  first(place: ScenePlace): number;
  /** Whether the end of the range stands for Infinity; default false. */
  readonly isEndless?: boolean;
  /** The option whose number stays larger than this one's: the one not being changed gives way. */
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
  /** The words with what people call them. The words are the same for all values. */
  choices(values: Values): Readonly<Record<Word, string>>;
  readonly first: Word;
}

/** x, y and z of the world. */
export interface VectorOption<Values = OptionValues> extends OptionFacts<Values> {
  readonly kind: 'vector';
  /** @param axis 0, 1 or 2. */
  range(place: ScenePlace, axis: number): readonly [min: number, max: number];
  first(place: ScenePlace): Vec3;
  /** The direction, of length 1, that a point only moves along; default: it moves anywhere. */
  along?(values: Values): Vec3 | null;
}

/** The word `camera`, or a point of the world: at first the scene's middle. */
export interface OriginOption<Values = OptionValues> extends OptionFacts<Values> {
  readonly kind: 'origin';
}

/** Control by which people choose one option of an effect. */
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

/** Options of an effect that people can choose. */
export interface EffectOptions {
  readonly effect: SplatEffect;
  /** By name, in the order in which they are shown and written: each before its dependents. */
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
 * Describes what people can choose for an effect.
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
