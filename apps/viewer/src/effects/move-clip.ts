import { type ClipValues, planeNormal } from '@websplatter/core/effect-options';
import { movedAlong, movedAway, movedInPicture, type PictureSpace } from '../camera/picture-space.ts';
import { roundedTo, stepFor } from '../state/nice-steps.ts';
import type { Vec3 } from '../state/vec3.ts';

/** CSS pixels that a key moves a clip by. */
const STEP_PX = 8;
const LARGE_STEP_PX = 40;
/** Places are as exact as a tenth of a slider's step. */
const EXACTNESS = 0.1;

const DIRECTIONS: Readonly<Record<string, Vec3>> = {
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  ArrowUp: [0, -1, 0],
  ArrowDown: [0, 1, 0],
  PageUp: [0, 0, 1],
  PageDown: [0, 0, -1],
};

/** CSS pixels by which a key moves its handle: right, down and away; null if it does not. */
export function stepOfKey(key: string, isLarge: boolean): Vec3 | null {
  const direction = DIRECTIONS[key];
  const px = isLarge ? LARGE_STEP_PX : STEP_PX;
  return direction ? [direction[0] * px, direction[1] * px, direction[2] * px] : null;
}

/** A clip moved in the picture by CSS pixels right, down and away; planes along their normal. */
export function movedClip<Values extends ClipValues>(
  space: PictureSpace,
  values: Values,
  [rightPx, downPx, awayPx]: Vec3,
  sceneRadius: number,
): Values {
  const { shape, center } = values;
  const moved =
    shape === 'plane'
      ? movedAlong(space, center, planeNormal(values), rightPx, downPx)
      : movedAway(space, movedInPicture(space, center, rightPx, downPx), awayPx);
  const step = EXACTNESS * stepFor(sceneRadius);
  return {
    ...values,
    center: [roundedTo(moved[0], step), roundedTo(moved[1], step), roundedTo(moved[2], step)],
  };
}
