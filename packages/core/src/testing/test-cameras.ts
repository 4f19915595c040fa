import {
  type Camera,
  cameraFromMatrices,
  orthographicCamera,
  perspectiveCamera,
} from '../data/camera/camera.ts';
import { multiply4 } from '../data/math/mat4.ts';

/** Cameras that look at a cloud of half extent 1 at the origin, part of it outside of the image. */
export function testCameras(aspect: number): Readonly<Record<string, Camera>> {
  const place = { position: [1.1, 0.6, 1.4], target: [0.1, -0.1, 0], up: [0.1, 1, 0.05], aspect } as const;
  const perspective = perspectiveCamera({ ...place, fovYDegrees: 50, near: 0.1, far: 100 });
  const offCentre = Float64Array.from(perspective.projectionMatrix);
  offCentre[8] = 0.4;
  offCentre[9] = -0.3;
  const mirror = Float64Array.of(-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
  return {
    perspective,
    inside: perspectiveCamera({
      ...place,
      position: [0.1, 0.05, 0.2],
      target: [0, 0.3, -1],
      fovYDegrees: 100,
    }),
    telephoto: perspectiveCamera({ ...place, position: [40, 30, 50], fovYDegrees: 1.5 }),
    orthographic: orthographicCamera({ ...place, height: 1.5 }),
    'off-centre': cameraFromMatrices(perspective.viewMatrix, offCentre),
    mirrored: cameraFromMatrices(perspective.viewMatrix, multiply4(mirror, perspective.projectionMatrix)),
  };
}

/** Model matrices for clouds in a scene; the cloud stays within a few units of the origin. */
export const TEST_MODELS: Readonly<Record<string, ArrayLike<number>>> = {
  identity: Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1),
  /** A quarter turn about an oblique axis, scaled by 0.7 and moved. */
  moved: Float64Array.of(
    ...[0.2333, 0.638, -0.1713, 0],
    ...[-0.1713, 0.2333, 0.638, 0],
    ...[0.638, -0.1713, 0.2333, 0],
    ...[0.3, -0.2, 0.1, 1],
  ),
  mirrored: Float64Array.of(1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0.1, 0, 0, 1),
  stretched: Float64Array.of(-1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0.5, 0, 0, 0.2, 0, 1),
  sheared: Float64Array.of(1, 0.3, 0, 0, 0.5, 1, -0.2, 0, 0, 0.4, 0.8, 0, 0, 0, 0.1, 1),
};
