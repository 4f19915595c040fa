import { InvalidArgumentError, type Vec3 } from '@websplatter/core';
import { EFFECTS, type EffectUse, type RevealOptions, type Volume } from '@websplatter/core/effects';
import {
  checkedReveal,
  encodedColor,
  type RevealAnimation,
  SplatCloudObject,
  type SplatData,
  volumeOf,
} from '@websplatter/three';
import type { Box3, Color, ColorRepresentation, Plane, Sphere } from 'three';

/** Clouds have their own `opacity` and `reveal`, and the scene's `fog`. */
const { opacity, fog, reveal, ...NAMED_EFFECTS } = EFFECTS;

type NamedEffects = typeof NAMED_EFFECTS;

/** Names of the effects that are properties of a cloud. */
const NAMES_OF_EFFECTS = /* @__PURE__ */ Object.keys(NAMED_EFFECTS) as (keyof NamedEffects)[];

/** Any of three's colours; or red, green and blue, sRGB-encoded, 0…1. */
export type SplatColor = ColorRepresentation | Vec3;

/** One of three's shapes, in world space. Without `shape`, the discriminant of `Volume`. */
type ThreeShape = (Box3 | Sphere | Plane) & { readonly shape?: never };

/** Any colour for an option named `color`. */
type InThree<Options> = Options extends { readonly color: unknown }
  ? Omit<Options, 'color'> & { readonly color: SplatColor }
  : Options;

type OptionProps = {
  [Name in Exclude<keyof NamedEffects, 'tint' | 'volumes'>]?: InThree<Parameters<NamedEffects[Name]>[0]>;
};

/**
 * One prop per effect, also a property of `ref.current`. Shaders contain only the effects in use; the
 * others cost nothing. Out-of-range numbers are clamped, with one warning for each prop.
 */
export interface EffectProps extends OptionProps {
  /**
   * Multiplies every colour, as a filter in front of the splats does: `'orange'`, or factors of red,
   * green and blue, 1 for no change: `[1, 0.5, 0]`.
   */
  tint?: SplatColor;
  /** Multiplies all light, as an exposure does: 2 is one stop brighter. */
  brightness?: number;
  /** Changes exposure in stops, saturation, temperature and tint: `{ exposure: 0.5, saturation: 1.2 }`. */
  grade?: OptionProps['grade'];
  /**
   * Makes splats thinner than a pixel fainter, as scenes expect that were trained with antialiasing:
   * true, or `{ dilationPx2: 0.1 }`, the variance of the filter. `false`: not even if the file asks.
   */
  antialias?: OptionProps['antialias'];
  /**
   * Crops, hides, fades, tints or displaces the splats in up to 256 volumes in world space, in their
   * order: `[{ shape: 'box', mode: 'keep', center: [0, 1, 0], size: [2, 2, 2] }]`. Three's Box3 and
   * Sphere keep their inside, a Plane the side that its normal points to. `<SplatVolume>` of
   * `@websplatter/react/components` is a volume as an object of the scene.
   */
  volumes?: readonly (Volume | ThreeShape)[];
  /**
   * Shows only splats within a radius. With `durationMs` in place of `radius`, makes the splats
   * appear over time: when they are first drawn, and again whenever these options or `src` change.
   */
  reveal?:
    | (RevealOptions & { readonly durationMs?: never })
    | (RevealAnimation & { readonly radius?: never });
  /**
   * Blurs splats that are nearer or farther than the plane in focus, as a lens does: `{ aperture: 0.02,
   * focusDistance: 1.5 }`, the radius of its opening and the view depth in focus, world units.
   */
  depthOfField?: OptionProps['depthOfField'];
  /** Mixes another colour into selected splats. Call `invalidate()` when the selection changes. */
  highlight?: OptionProps['highlight'];
  /** More effects, from `@websplatter/core/effects` or your own. */
  effects?: readonly EffectUse[];
}

/** Values of a cloud's effect properties; null: the effect is off. */
type NamedOptions = { [Name in keyof NamedEffects]: EffectProps[Name] | null };

/** Returns `value` clamped to 0…`max`, and may warn. */
export type Clamp = (property: string, value: number, max: number) => number;

/** The largest numbers that options of these names take; the smallest is 0. */
const LARGEST: Readonly<Record<string, number>> = {
  aperture: Number.POSITIVE_INFINITY,
  brightness: 2 ** 20,
  color: 1,
  height: Number.POSITIVE_INFINITY,
  opacity: 1,
  saturation: 4,
  radius: Number.POSITIVE_INFINITY,
  size: Number.POSITIVE_INFINITY,
  softEdge: Number.POSITIVE_INFINITY,
  strength: 1,
  tint: Number.POSITIVE_INFINITY,
};

/**
 * Moves the props of effects from `props` to an object of their own, with three's colours and shapes
 * converted to plain values, which can be compared by content.
 *
 * @throws InvalidArgumentError for a value that is not a colour.
 */
export function takeEffectProps(props: Record<string, unknown>): EffectProps {
  const taken: Record<string, unknown> = {};
  for (const name of [...NAMES_OF_EFFECTS, 'reveal', 'effects']) {
    const value = props[name];
    taken[name] = isOff(name, value) ? undefined : inEngine(name, value);
    delete props[name];
  }
  return taken;
}

/**
 * Returns the effects that these options request.
 *
 * @throws InvalidArgumentError for invalid options.
 */
export function usesOfOptions(given: Partial<NamedOptions>, clamp: Clamp): EffectUse[] {
  return Object.entries(NAMED_EFFECTS).flatMap(([name, use]) => {
    const options = given[name as keyof NamedEffects];
    if (isOff(name, options)) return [];
    return use(clampedOptions(name, name, inEngine(name, options), clamp) as never);
  });
}

/** The class of three with a property for each effect, null at first. */
const ObjectOfThree = SplatCloudObject as unknown as new (
  data?: SplatData | null,
) => SplatCloudObject & Omit<NamedOptions, 'tint'>;

/** A cloud with the effects of `<Splats>` as properties. They are read at each draw: another value requests no frame. */
export class ObjectWithEffects extends ObjectOfThree {
  #tint: SplatColor | null = null;

  constructor(data: SplatData | null = null) {
    super(data);
    // react-three-fiber resets removed props to these values.
    for (const name of NAMES_OF_EFFECTS) Object.assign(this, { [name]: null });
  }

  /**
   * Multiplies every colour: see `EffectProps`. A Color is converted when it is set; the getter
   * returns red, green and blue, sRGB-encoded.
   */
  get tint(): SplatColor | null {
    return this.#tint;
  }

  set tint(color: SplatColor | null) {
    // react-three-fiber would copy the next colour into a Color that is kept here.
    this.#tint = (color as Color | null)?.isColor ? colorInEngine(color!) : color;
  }

  protected override ownEffects(): readonly EffectUse[] {
    const uses = usesOfOptions(this, (...number) => this.clamped(...number));
    return [...uses, ...super.ownEffects()];
  }

  override copy(source: this, recursive?: boolean): this {
    super.copy(source, recursive);
    for (const name of NAMES_OF_EFFECTS) Object.assign(this, { [name]: source[name] });
    return this;
  }
}

function isOff(name: string, options: unknown): boolean {
  // `false` is one of the options of `antialias` alone.
  return options == null || (options === false && name !== 'antialias');
}

/**
 * Checks props before they are set on an object, where a frame would report them.
 *
 * @throws InvalidArgumentError for invalid options.
 */
export function checkEffectProps(
  props: EffectProps & { readonly [Name in 'opacity' | 'fade' | 'relight']?: number },
): void {
  const silently: Clamp = (_property, value, max) =>
    Number.isFinite(value) ? Math.min(Math.max(value, 0), max) : value;
  if (props.opacity !== undefined) opacity(silently('opacity', props.opacity, 1));
  for (const name of ['fade', 'relight'] as const)
    if (!Number.isFinite(props[name] ?? 1))
      throw new InvalidArgumentError(name, `${name} is ${props[name]}; it must be a number from 0 to 1.`);
  usesOfOptions(props, silently);
  const options = props.reveal;
  if (options && options.durationMs !== undefined) checkedReveal(options as RevealAnimation);
  else if (options) reveal(clampedOptions('reveal', 'reveal', options, silently) as RevealOptions);
  const effects = props.effects ?? [];
  if (!Array.isArray(effects) || [...effects].some((use) => !use?.effect))
    throw new InvalidArgumentError(
      'effects',
      'effects must be a list of what effects return: [tint([1, 0, 0])].',
    );
}

/** Whether both lists have the same effects in the same order, with equal options. */
export function isSameUses(a: readonly EffectUse[] = [], b: readonly EffectUse[] = []): boolean {
  return (
    a.length === b.length &&
    a.every((use, i) => use.effect === b[i].effect && isSameValue(use.options, b[i].options))
  );
}

/** Compares arrays and plain objects by content, everything else by identity. */
export function isSameValue(a: unknown, b: unknown): boolean {
  if (Object.is(a, b)) return true;
  if (!(isPlain(a) && isPlain(b)) || Array.isArray(a) !== Array.isArray(b)) return false;
  const keys = Object.keys(a);
  return (
    keys.length === Object.keys(b).length && keys.every((key) => key in b && isSameValue(a[key], b[key]))
  );
}

function isPlain(value: unknown): value is Record<string, unknown> {
  if (typeof value !== 'object' || value === null) return false;
  return Array.isArray(value) || Object.getPrototypeOf(value) === Object.prototype;
}

/**
 * Returns the options of the effect `effect` with their numbers within range.
 *
 * @param name name of the option `value`.
 */
function clampedOptions(effect: string, name: string, value: unknown, clamp: Clamp): unknown {
  if (typeof value === 'number') return name in LARGEST ? clamp(effect, value, LARGEST[name]) : value;
  if (!isPlain(value)) return value;
  const clamped = (key: string, part: unknown) => clampedOptions(effect, key, part, clamp);
  if (Array.isArray(value)) return value.map((part) => clamped(name, part));
  return Object.fromEntries(Object.entries(value).map(([key, part]) => [key, clamped(key, part)]));
}

/** Options of the effect `name` with the engine's colours and shapes in place of three's. */
function inEngine(name: string, options: unknown): unknown {
  if (name === 'tint') return colorInEngine(options as SplatColor);
  if (name === 'volumes') return Array.isArray(options) ? options.map(toVolume) : options;
  const { color } = options as { color?: SplatColor };
  return color === undefined ? options : { ...(options as object), color: colorInEngine(color) };
}

export function colorInEngine(color: SplatColor): Vec3 {
  return Array.isArray(color) ? (color as Vec3) : encodedColor(color as ColorRepresentation);
}

function toVolume(volume: Volume | ThreeShape): Volume {
  // three's shapes can be cloned, options cannot. `volumes` refuses values that are neither.
  const isShape = (volume as Box3 | null)?.clone;
  return isShape ? volumeOf(volume as Box3) : (volume as Volume);
}
