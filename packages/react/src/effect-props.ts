import { InvalidArgumentError } from '@websplatter/core';
import {
  antialias,
  brightness,
  type ClipOptions,
  type ClipVolume,
  clip,
  type EffectUse,
  type HighlightOptions,
  highlight,
  type RevealOptions,
  reveal,
  tint,
} from '@websplatter/core/effects';
import { checkedReveal, clipVolumeOf, encodedColor, type RevealAnimation } from '@websplatter/three';
import type { Box3, ColorRepresentation, Plane, Sphere } from 'three';

/** One prop per effect. Shaders contain only the effects in use; the others cost nothing. */
export interface EffectProps {
  /** Multiplies every colour, as a filter in front of the splats does. White changes nothing. */
  tint?: ColorRepresentation;
  /** Multiplies all light, as an exposure does: 2 is one stop brighter. */
  brightness?: number;
  /** For scenes trained with antialiasing (Mip-Splatting, gsplat's `antialiased`): splats thinner than a pixel become fainter. */
  antialias?: boolean;
  /** Clips the splats by volumes in world space; a Plane keeps the side that its normal points to. */
  clip?: Omit<ClipOptions, 'volumes'> & { readonly volumes: readonly (ClipVolume | Box3 | Sphere | Plane)[] };
  /**
   * Shows only splats within a radius. With `durationMs` in place of `radius`, makes the splats appear over time: when they
   * are first drawn, and again whenever these options or `src` change.
   */
  reveal?:
    | (RevealOptions & { readonly durationMs?: never })
    | (RevealAnimation & { readonly radius?: never });
  /** Mixes another colour into selected splats. After changing the selection, request a frame with `invalidate()`. */
  highlight?: Omit<HighlightOptions, 'color'> & { readonly color: ColorRepresentation };
  /** More effects, from `@websplatter/core/effects` or your own. */
  effects?: readonly EffectUse[];
}

/**
 * Returns the effects that these props request.
 *
 * @throws InvalidArgumentError for invalid options.
 */
export function usesOfProps(props: EffectProps): EffectUse[] {
  const uses: EffectUse[] = [];
  if (props.clip) {
    const { volumes } = props.clip;
    uses.push(clip({ ...props.clip, volumes: Array.isArray(volumes) ? volumes.map(toVolume) : [] }));
  }
  if (props.reveal && !isAnimation(props.reveal)) uses.push(reveal(props.reveal));
  if (props.antialias !== undefined) uses.push(antialias(props.antialias));
  if (props.brightness !== undefined) uses.push(brightness(props.brightness));
  if (props.tint !== undefined) uses.push(tint(encodedColor(props.tint)));
  if (props.highlight)
    uses.push(highlight({ ...props.highlight, color: encodedColor(props.highlight.color) }));
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

function isAnimation(options: RevealOptions | RevealAnimation): options is RevealAnimation {
  return (options as RevealAnimation).durationMs !== undefined;
}

function toVolume(volume: ClipVolume | Box3 | Sphere | Plane): ClipVolume {
  // three's shapes can be cloned, options cannot. `clip` refuses what is neither.
  const isShape = (volume as Box3 | null)?.clone;
  return isShape ? clipVolumeOf(volume as Box3) : (volume as ClipVolume);
}
