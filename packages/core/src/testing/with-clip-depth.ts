import { type Camera, cameraFromMatrices } from '../data/camera/camera.ts';

/** Returns `camera` with clip depths of 0…1, reversed or not, as three.js makes them for WebGPU. */
export function withClipDepth(camera: Camera, isReversed: boolean): Camera {
  const { near, far, viewMatrix } = camera;
  const p = Float64Array.from(camera.projectionMatrix);
  const isOrthographic = p[11] === 0;
  const range = 1 / (far - near);
  if (isOrthographic) [p[10], p[14]] = isReversed ? [range, far * range] : [-range, -near * range];
  else [p[10], p[14]] = isReversed ? [near * range, far * near * range] : [-far * range, -far * near * range];
  return cameraFromMatrices(viewMatrix, p, { near, far });
}
