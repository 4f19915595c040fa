import { type Camera, perspectiveCamera, type ShDegree } from '@websplatter/core';
import type { HardCaseGroup, HardCloud, SceneCase } from './hard-case.ts';
import { ordinarySplats, type SplatValues, splatsOf } from './make-splats.ts';

/** Values of a scene case; cameras default to `frontAndOblique`. */
export type SceneValues = Omit<SceneCase, 'kind' | 'group' | 'cameras'> & Partial<Pick<SceneCase, 'cameras'>>;

/** Makes scene cases of one group. */
export function scenesOf(group: HardCaseGroup): (values: SceneValues) => SceneCase {
  return (values) => ({ kind: 'scene', group, cameras: frontAndOblique, ...values });
}

/** One cloud: `hard` splats among ordinary ones, stored after them. */
export function amongOrdinary(
  hard: readonly SplatValues[],
  options: { readonly shDegree?: ShDegree } = {},
): () => readonly HardCloud[] {
  return () => [{ set: splatsOf([...ordinarySplats(), ...hard], options) }];
}

/** The ordinary splats of `amongOrdinary` without a hard one; not in the catalogue. */
export const ORDINARY_SCENE: SceneCase = {
  kind: 'scene',
  group: 'scale',
  name: 'ordinary',
  breaks: 'Nothing.',
  clouds: amongOrdinary([]),
  cameras: frontOnly,
};

/** Vertical field of view of `front`, degrees. */
const FRONT_FOV_DEGREES = 60;
/** Distance of `front` from the origin. */
const FRONT_DISTANCE = 5;
/** Pixels per world unit at the origin, in an image of `front` with 64 rows. */
export const FRONT_PX_PER_UNIT = 32 / Math.tan((FRONT_FOV_DEGREES * Math.PI) / 360) / FRONT_DISTANCE;

/** Camera at (0, 0, 5) looking along −z: its view matrix has no rounding at all. */
export function front(aspect: number): Camera {
  return perspectiveCamera({
    position: [0, 0, FRONT_DISTANCE],
    target: [0, 0, 0],
    fovYDegrees: FRONT_FOV_DEGREES,
    aspect,
  });
}

export function frontOnly(aspect: number): Readonly<Record<string, Camera>> {
  return { front: front(aspect) };
}

export function frontAndOblique(aspect: number): Readonly<Record<string, Camera>> {
  return {
    front: front(aspect),
    oblique: perspectiveCamera({
      position: [2.1, 1.3, 4.2],
      target: [0.1, -0.2, 0],
      fovYDegrees: 50,
      aspect,
    }),
  };
}

/** Camera at the origin looking along −z, so that depth is exactly −z. */
export function atOrigin(
  aspect: number,
  range: { readonly near: number; readonly far: number },
): Readonly<Record<string, Camera>> {
  return {
    origin: perspectiveCamera({
      position: [0, 0, 0],
      target: [0, 0, -1],
      fovYDegrees: FRONT_FOV_DEGREES,
      aspect,
      ...range,
    }),
  };
}
