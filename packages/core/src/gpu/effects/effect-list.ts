import type { SplatEffect } from './effect.ts';

/** What the list of a frame's effects says of an effect, whether or not its code has been fetched. */
export type ListedEffect = Pick<SplatEffect, 'name' | 'label' | 'about' | 'hooks'>;

/**
 * All effects of this package, in the order in which they act. Apart from their code, so that pages fetch
 * only that of effects that they use.
 */
export const EFFECT_LIST = {
  volumes: {
    name: 'volumes',
    label: 'Volumes',
    about: 'Hides, keeps, fades, tints or displaces the splats in boxes, spheres and other shapes.',
    hooks: { splat: 'changeByVolumes', color: 'tintByVolumes' },
  },
  reveal: {
    name: 'reveal',
    label: 'Reveal',
    about: 'Lets a cloud appear outward from a point or from the camera.',
    hooks: { splat: 'revealSplat' },
  },
  opacity: {
    name: 'opacity',
    label: 'Opacity',
    about: 'Makes a whole cloud fainter.',
    hooks: { splat: 'fadeSplat' },
  },
  antialias: {
    name: 'antialias',
    label: 'Antialiasing',
    about: 'Makes splats thinner than a pixel fainter, by the factor that they are drawn wider.',
    hooks: { opacity: 'compensateDilation' },
  },
  depthOfField: {
    name: 'depth-of-field',
    label: 'Depth of field',
    about: 'Blurs splats that are nearer or farther than the plane in focus.',
    hooks: { opacity: 'keepLight', screen: 'spreadByLens' },
  },
  brightness: {
    name: 'brightness',
    label: 'Brightness',
    about: 'Makes a cloud brighter or darker, like an exposure.',
    hooks: { color: 'exposeColor' },
  },
  grade: {
    name: 'grade',
    label: 'Grade',
    about: 'Changes exposure, saturation and white balance; saved files can contain it.',
    hooks: { color: 'gradeColor' },
  },
  tint: {
    name: 'tint',
    label: 'Tint',
    about: 'Colours a cloud, like a filter in front of it.',
    hooks: { color: 'tintColor' },
  },
  highlight: {
    name: 'highlight',
    label: 'Highlight',
    about: 'Shows which splats are selected.',
    hooks: { color: 'highlightColor' },
  },
  fog: {
    name: 'fog',
    label: 'Fog',
    about: 'Fades distant splats into a colour.',
    hooks: { color: 'fogColor' },
  },
} as const satisfies Readonly<Record<string, ListedEffect>>;

const ORDER: readonly ListedEffect[] = /* @__PURE__ */ Object.values(EFFECT_LIST);

/** Returns the place of an effect in the list; −1 for the effect of a caller. */
export function placeInList(effect: ListedEffect): number {
  return ORDER.findIndex((listed) => isSameEffect(listed, effect));
}

/** Callers may give their own effect the name of a listed one; its hooks are other objects. */
export function isSameEffect(a: ListedEffect, b: ListedEffect): boolean {
  return a.name === b.name && a.hooks === b.hooks;
}
