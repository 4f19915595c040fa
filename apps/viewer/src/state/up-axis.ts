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

/** The axis that comes closest to a direction. */
export function nearestUpAxis([, y, z]: Vec3): UpAxis {
  const isZUp = Math.abs(z) > Math.abs(y);
  return upAxisOf({ isZUp, isFlipped: (isZUp ? z : y) < 0 });
}

/** Whether a scene that comes with the axis `first` up is shown the other way up. */
export function isUpsideDown({ isFlipped, isZUp }: Uprightness, first: UpAxis): boolean {
  const own = uprightnessOf(first);
  // Another axis upwards is as it comes.
  return isFlipped !== (own.isFlipped && own.isZUp === isZUp);
}
