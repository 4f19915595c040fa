import type { Camera } from '@websplatter/core';

/** The camera of `camera`'s image, scaled, then shifted right and up, in halves of its sides. */
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
