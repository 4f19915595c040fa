import type { Camera } from '../data/camera/camera.ts';
import { InvalidArgumentError } from '../data/errors.ts';
import { given } from '../data/given.ts';
import type { Bounds } from '../data/packing/packed-cloud.ts';
import { pivotDepth, turnedAboutPivot } from './camera-pivot.ts';
import { checkCounts } from './check-options.ts';

/**
 * Returns the cameras of `count` successive frames that go around the scene in front of `camera`,
 * in steps of `sweepDegrees / count`, with `camera` in the middle. All look at one point of its line
 * of sight, and turn about the image's vertical. At 360° one more step would lead back to the first
 * camera.
 *
 * @param bounds bounds of the scene, world space; for a single cloud without a model matrix
 * `cloud.robustBounds`.
 * @throws InvalidArgumentError if `count` is not a whole number of at least 1, or `sweepDegrees` is
 * not above 0 and at most 360.
 * @example
 * const pictures = [];
 * const orbit = { count: 120, sweepDegrees: 360 };
 * for (const each of orbitCameras(camera, cloud.robustBounds, orbit)) {
 *   view.render({ camera: each, clouds: [{ cloud }], widthPx, heightPx });
 *   pictures.push(await view.readPixels());
 * }
 */
export function orbitCameras(
  camera: Camera,
  bounds: Bounds,
  options: { readonly count: number; readonly sweepDegrees: number },
): Camera[] {
  const { count, sweepDegrees } = given(options, { count: 'a number', sweepDegrees: 'a number' });
  checkCounts({ count });
  if (!(sweepDegrees > 0 && sweepDegrees <= 360)) {
    const message = `sweepDegrees is ${sweepDegrees}; it must be above 0 and at most 360.`;
    throw new InvalidArgumentError('sweepDegrees', message);
  }
  const depth = pivotDepth(camera, bounds);
  const step = ((sweepDegrees / count) * Math.PI) / 180;
  return Array.from({ length: count }, (_, index) =>
    turnedAboutPivot(camera, depth, { aboutY: (index - Math.floor(count / 2)) * step }),
  );
}
