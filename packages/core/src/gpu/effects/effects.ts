import { antialias } from './antialias/antialias.ts';
import { brightness } from './brightness/brightness.ts';
import { depthOfField } from './depth-of-field/depth-of-field.ts';
import type { EFFECT_LIST } from './effect-list.ts';
import { fog } from './fog/fog.ts';
import { grade } from './grade/grade.ts';
import { highlight } from './highlight/highlight.ts';
import { opacity } from './opacity/opacity.ts';
import { reveal } from './reveal/reveal.ts';
import { tint } from './tint/tint.ts';
import { volumes } from './volumes/volumes.ts';

export * from './antialias/antialias.ts';
export * from './brightness/brightness.ts';
export * from './depth-of-field/depth-of-field.ts';
export * from './fog/fog.ts';
export * from './grade/grade.ts';
export * from './highlight/highlight.ts';
export * from './opacity/opacity.ts';
export * from './reveal/reveal.ts';
export * from './tint/tint.ts';
export * from './volumes/volumes.ts';

/** The functions of all effects of this package, in the order of EFFECT_LIST. */
export const EFFECTS = {
  volumes,
  reveal,
  opacity,
  antialias,
  depthOfField,
  brightness,
  grade,
  tint,
  highlight,
  fog,
} as const satisfies Readonly<Record<keyof typeof EFFECT_LIST, unknown>>;
