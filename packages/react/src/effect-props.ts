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
import { Box3, type ColorRepresentation, Plane, Sphere } from 'three';

/** A prop for each effect. What is not asked for is in no shader and costs nothing. */
export interface EffectProps {
  /** Multiplies every colour, as a filter in front of the splats does. White changes nothing. */
  tint?: ColorRepresentation;
  /** Multiplies all light, as an exposure does: 2 is one stop brighter. */
  brightness?: number;
  /** For scenes trained with antialiasing (Mip-Splatting, gsplat's `antialiased`): splats thinner than a pixel become fainter. */
  antialias?: boolean;
  /** Cuts the splats off at volumes in world space; of a Plane the side that its normal points to stays. */
  clip?: Omit<ClipOptions, 'volumes'> & { readonly volumes: readonly (ClipVolume | Box3 | Sphere | Plane)[] };
  /**
   * Only what is within a radius is there; or, with `durationMs` in place of `radius`, the splats appear by themselves: when
   * they are first drawn, and again whenever these options or `src` change.
   */
  reveal?: RevealOptions | RevealAnimation;
  /** Mixes the colour of selected splats with another. After a change of the selection, ask for a frame by `invalidate()`. */
  highlight?: Omit<HighlightOptions, 'color'> & { readonly color: ColorRepresentation };
  /** More effects, of `@websplatter/core/effects` or of your own. */
  effects?: readonly EffectUse[];
}

/**
 * What these props ask for.
 *
 * @throws InvalidArgumentError for options that mean nothing.
 */
export function usesOfProps(props: EffectProps): EffectUse[] {
  const uses: EffectUse[] = [];
  if (props.clip)
    uses.push(clip({ ...props.clip, volumes: props.clip.volumes.map((volume) => toVolume(volume)) }));
  if (props.reveal && !isAnimation(props.reveal)) uses.push(reveal(props.reveal));
  if (props.antialias !== undefined) uses.push(antialias(props.antialias));
  if (props.brightness !== undefined) uses.push(brightness(props.brightness));
  if (props.tint !== undefined) uses.push(tint(encodedColor(props.tint)));
  if (props.highlight)
    uses.push(highlight({ ...props.highlight, color: encodedColor(props.highlight.color) }));
  return [...uses, ...(props.effects ?? [])];
}

/**
 * The animation that these props ask for, or null.
 *
 * @throws InvalidArgumentError for options that mean nothing.
 */
export function revealAnimationOf({ reveal: options }: EffectProps): RevealAnimation | null {
  return options && isAnimation(options) ? checkedReveal(options) : null;
}

/** Whether both do the same. */
export function isSameUses(a: readonly EffectUse[], b: readonly EffectUse[]): boolean {
  return (
    a.length === b.length &&
    a.every((use, i) => use.effect === b[i].effect && isSameValue(use.options, b[i].options))
  );
}

/** Arrays and plain objects by what is in them, all else by identity. */
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
  return 'durationMs' in options;
}

function toVolume(volume: ClipVolume | Box3 | Sphere | Plane): ClipVolume {
  const isShape = volume instanceof Box3 || volume instanceof Sphere || volume instanceof Plane;
  return isShape ? clipVolumeOf(volume) : volume;
}
