import type { Vec3 } from '../math/mat4.ts';

/**
 * What a scene is to a camera: an `object` is looked at from outside; something `surrounded`, such
 * as a statue in a park or an outlook, from a place in its surroundings; something `enclosed`, such
 * as a room, from within.
 */
export type SceneKind = 'object' | 'surrounded' | 'enclosed';

/** A first camera for a scene, and what was found on the way; places are in world space. */
export interface SceneFraming {
  readonly kind: SceneKind;
  /** The camera's place, and what it looks at. */
  readonly position: Vec3;
  readonly target: Vec3;
  /** Unit vector that is up in the scene, and in the picture. */
  readonly up: Vec3;
  /** Vertical field of view that position and target were chosen for, in degrees. */
  readonly fovYDegrees: number;
  /** Middle of the scene's detail, and the distance within which four fifths of it lie. */
  readonly center: Vec3;
  readonly radius: number;
  /** Height of the ground, as the product of `up` and any point of it; null if none was found. */
  readonly groundHeight: number | null;
  /** How sure it is, 0…1: below about 0.5 something else is as likely. */
  readonly confidence: {
    /** Of `up`: 1 where it was given. */
    readonly up: number;
    /** Of `kind`. */
    readonly kind: number;
  };
}

/** What a framing is made for. */
export interface FramingWishes {
  /** Width of the image over its height. */
  readonly aspect: number;
  readonly fovYDegrees: number;
  /** Up, if it is known: any length above 0. */
  readonly up: Vec3 | null;
  /** Up where the scene does not tell: a unit vector. */
  readonly usualUp: Vec3;
  /** Null: what is found. */
  readonly kind: SceneKind | null;
}
