import type { Camera } from '@websplatter/core';

/** The camera whose image is that of `camera`, scaled and then shifted right and up; lengths in halves of the image's sides. */
export function reprojected(
  camera: Camera,
  [scaleX, scaleY]: readonly [number, number],
  [shiftX, shiftY]: readonly [number, number],
): Camera {
  const matrix = Float64Array.from(camera.projectionMatrix);
  // Places are divided by w: a shift counts w times.
  for (let column = 0; column < 16; column += 4) {
    matrix[column] = scaleX * matrix[column] + shiftX * matrix[column + 3];
    matrix[column + 1] = scaleY * matrix[column + 1] + shiftY * matrix[column + 3];
  }
  return { ...camera, projectionMatrix: matrix };
}
