import type { Bounds } from '@websplatter/core';
import type { Vec3 } from './vec3.ts';

export const UP_AXES = ['y', '-y', 'z', '-z'] as const;

/** The axis of a scene's own that is shown upwards. */
export type UpAxis = (typeof UP_AXES)[number];

/** The axes with their names. */
export const UP_CHOICES = UP_AXES.map((axis) => [axis, axis.replace('-', '−')] as const);

/** How an axis of the scene comes to point up: by half a turn around x or not, with y or z up. */
export interface Uprightness {
  readonly isFlipped: boolean;
  readonly isZUp: boolean;
}

export const Y_UP: Vec3 = [0, 1, 0];
const Z_UP: Vec3 = [0, 0, 1];

export function upVector({ isZUp }: Pick<Uprightness, 'isZUp'>): Vec3 {
  return isZUp ? Z_UP : Y_UP;
}

export function upAxisOf({ isFlipped, isZUp }: Uprightness): UpAxis {
  const axis = isZUp ? 'z' : 'y';
  return isFlipped ? `-${axis}` : axis;
}

export function uprightnessOf(axis: UpAxis): Uprightness {
  return { isFlipped: axis.startsWith('-'), isZUp: axis.endsWith('z') };
}

export function oppositeAxis(axis: UpAxis): UpAxis {
  const { isFlipped, isZUp } = uprightnessOf(axis);
  return upAxisOf({ isFlipped: !isFlipped, isZUp });
}

/** A scene with a height below this part of both its width and its length is ground. */
const GROUND_FLATNESS = 0.25;
/** Ground is at most this many times as long as wide; a longer scene may be a wall. */
const GROUND_LENGTH = 3;

/**
 * Whether a scene of this box is probably a survey of ground, by its shape alone: flat along z and
 * about as wide as long. Such are mostly in maps' coordinates, in which z points up.
 */
export function isProbablyZUp({ min, max }: Bounds): boolean {
  const [x, y, z] = [0, 1, 2].map((axis) => max[axis] - min[axis]);
  const narrower = Math.min(x, y);
  return z > 0 && z < GROUND_FLATNESS * narrower && Math.max(x, y) < GROUND_LENGTH * narrower;
}
