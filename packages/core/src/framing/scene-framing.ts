import type { Vec3 } from '../data/math/mat4.ts';

/**
 * Where a camera stands. An `object` is viewed from outside. A `surrounded` subject, such as a statue
 * in a park, is viewed from a place in its surroundings. An `enclosed` scene, such as a room, is viewed
 * from within.
 */
export type SceneKind = 'object' | 'surrounded' | 'enclosed';

/** A first camera for a scene, with the facts that it was chosen by. Positions are in world space. */
export interface SceneFraming {
  readonly kind: SceneKind;
  /** Position of the camera; it looks at `target`. */
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

/** Image shape and known facts that a first camera is chosen for. */
export interface FramingWishes {
  /** Width of the image over its height. */
  readonly aspect: number;
  readonly fovYDegrees: number;
  /** Up, if it is known: any length above 0. */
  readonly up: Vec3 | null;
  /** Unit vector that is up if the scene has no clear up direction. */
  readonly usualUp: Vec3;
  /** Kind of the scene; null if it is to be found. */
  readonly kind: SceneKind | null;
}
