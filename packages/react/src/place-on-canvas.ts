import type { Camera, Vector3 } from 'three';

/** Position of a world point on a canvas. */
export interface CanvasPlace {
  /** CSS pixels from the canvas's left. */
  readonly x: number;
  /** CSS pixels from its top. */
  readonly y: number;
  /** Distance along the camera's line of sight, world units. */
  readonly depthView: number;
}

/**
 * Returns the position of a point in the last frame from `camera`, also outside of the canvas; null
 * behind the camera.
 *
 * @param size size of the canvas, CSS pixels.
 */
export function placeOnCanvas(
  point: Vector3,
  camera: Camera,
  { width, height }: { readonly width: number; readonly height: number },
): CanvasPlace | null {
  const depthView = -point.clone().applyMatrix4(camera.matrixWorldInverse).z;
  if (!(depthView > 0)) return null;
  const { x, y } = point.clone().project(camera);
  return { x: ((1 + x) / 2) * width, y: ((1 - y) / 2) * height, depthView };
}
