import type { Camera } from '@websplatter/core';

/** Scales the image of `camera`, then shifts it right and up, in halves of its sides. */
export function reprojected(
  camera: Camera,
  [scaleX, scaleY]: readonly [number, number],
  [shiftX, shiftY]: readonly [number, number],
): Camera {
  const matrix = Float64Array.from(camera.projectionMatrix);
  // Positions are divided by w, so a shift is multiplied by w.
  for (let column = 0; column < 16; column += 4) {
    matrix[column] = scaleX * matrix[column] + shiftX * matrix[column + 3];
    matrix[column + 1] = scaleY * matrix[column + 1] + shiftY * matrix[column + 3];
  }
  return { ...camera, projectionMatrix: matrix };
}
