import { InvalidArgumentError } from '@websplatter/core';
import {
  type ClipOptions,
  type ClipVolume,
  EFFECTS,
  type EffectUse,
  type RevealOptions,
} from '@websplatter/core/effects';
import { checkedReveal, clipVolumeOf, encodedColor, type RevealAnimation } from '@websplatter/three';
import type { Box3, ColorRepresentation, Plane, Sphere } from 'three';

/** Effects with props of their names. Clouds have their own `opacity`, and the scene's `fog`. */
const { opacity, fog, ...PROP_EFFECTS } = EFFECTS;

type PropEffects = typeof PROP_EFFECTS;

/** Any of three's colours for an option named `color`. */
type InThree<Options> = Options extends { readonly color: unknown }
  ? Omit<Options, 'color'> & { readonly color: ColorRepresentation }
  : Options;

type OptionProps = {
  [Name in Exclude<keyof PropEffects, 'tint' | 'clip' | 'reveal'>]?: InThree<
    Parameters<PropEffects[Name]>[0]
  >;
};

/** One prop per effect. Shaders contain only the effects in use; the others cost nothing. */
export interface EffectProps extends OptionProps {
  /** Multiplies every colour, as a filter in front of the splats does. White changes nothing. */
  tint?: ColorRepresentation;
  /** Multiplies all light, as an exposure does: 2 is one stop brighter. */
  brightness?: number;
  /**
   * For scenes trained with antialiasing (Mip-Splatting, gsplat's `antialiased`): splats thinner
   * than a pixel become fainter.
   */
  antialias?: boolean;
  /** Clips splats by volumes in world space; a Plane keeps the side that its normal points to. */
  clip?: Omit<ClipOptions, 'volumes'> & { readonly volumes: readonly (ClipVolume | Box3 | Sphere | Plane)[] };
  /**
   * Shows only splats within a radius. With `durationMs` in place of `radius`, makes the splats
   * appear over time: when they are first drawn, and again whenever these options or `src` change.
   */
  reveal?:
    | (RevealOptions & { readonly durationMs?: never })
    | (RevealAnimation & { readonly radius?: never });
  /** Mixes another colour into selected splats. Call `invalidate()` when the selection changes. */
  highlight?: OptionProps['highlight'];
  /** More effects, from `@websplatter/core/effects` or your own. */
  effects?: readonly EffectUse[];
}

/** Moves the props of effects from `props` to an object of their own. */
export function takeEffectProps(props: Record<string, unknown>): EffectProps {
  const taken: Record<string, unknown> = {};
  for (const name of [...Object.keys(PROP_EFFECTS), 'effects']) {
    taken[name] = props[name];
    delete props[name];
  }
  return taken;
}

/**
 * Returns the effects that these props request.
 *
 * @throws InvalidArgumentError for invalid options.
 */
export function usesOfProps(props: EffectProps): EffectUse[] {
  const uses = Object.entries(PROP_EFFECTS).flatMap(([name, use]) => {
    const options = props[name as keyof PropEffects];
    // `false` is one of the options of `antialias` alone.
    const isOff = options == null || (options === false && name !== 'antialias');
    return isOff || isAnimation(options) ? [] : use(inEngine(name, options) as never);
  });
  const effects = props.effects ?? [];
  if (!Array.isArray(effects) || [...effects].some((use) => !use?.effect))
    throw new InvalidArgumentError(
      'effects',
      'effects must be a list of what effects return: [tint([1, 0, 0])].',
    );
  return [...uses, ...effects];
}

/**
 * Returns the animation that these props request, or null.
 *
 * @throws InvalidArgumentError for invalid options.
 */
export function revealAnimationOf({ reveal: options }: EffectProps): RevealAnimation | null {
  return options && isAnimation(options) ? checkedReveal(options) : null;
}

/** Whether both lists have the same effects in the same order, with equal options. */
export function isSameUses(a: readonly EffectUse[], b: readonly EffectUse[]): boolean {
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

function isAnimation(options: unknown): options is RevealAnimation {
  return (options as RevealAnimation).durationMs !== undefined;
}

/** Options of the effect `name` with the engine's colours and shapes in place of three's. */
function inEngine(name: string, options: unknown): unknown {
  if (name === 'tint') return encodedColor(options as ColorRepresentation);
  const { volumes, color } = options as { volumes?: readonly ClipVolume[]; color?: ColorRepresentation };
  if (name === 'clip')
    return { ...(options as object), volumes: Array.isArray(volumes) ? volumes.map(toVolume) : [] };
  return color === undefined ? options : { ...(options as object), color: encodedColor(color) };
}

function toVolume(volume: ClipVolume | Box3 | Sphere | Plane): ClipVolume {
  // three's shapes can be cloned, options cannot. `clip` refuses values that are neither.
  const isShape = (volume as Box3 | null)?.clone;
  return isShape ? clipVolumeOf(volume as Box3) : (volume as ClipVolume);
}
