import { invert3, linearPart, type Mat3, multiply4, transform3, type Vec3 } from '../math/mat4.ts';

/** A cloud as the camera sees it, all in float64 and relative to the cloud's origin. */
export interface CloudView {
  /** Linear part of cloud space to view space, column-major 3×3. */
  readonly linear: Mat3;
  /** Inverse of `linear`; null if the model matrix is singular. */
  readonly inverse: Mat3 | null;
  /** The cloud's origin in view space. */
  readonly translation: readonly [number, number, number];
  /**
   * Position of the camera in cloud space, relative to the cloud's origin; null if the model matrix
   * is singular, and for an orthographic camera, whose viewing directions are all `direction`.
   */
  readonly camera: readonly [number, number, number] | null;
  /** Direction in which the camera looks, in cloud space, not normalised. */
  readonly direction: readonly [number, number, number];
}

/** Viewing direction if the camera is at the splat's centre, or the model matrix is singular. */
export const FALLBACK_DIRECTION: Vec3 = [0, 0, 1];

/** Scratch memory. */
const modelView = new Float64Array(16);

/**
 * Returns the cloud as the camera sees it. Spherical harmonics are evaluated along the line of
 * sight in the cloud's own space. For a scaled, mirrored or sheared cloud, that takes the inverse
 * of the whole linear part, not of its rotation alone: a mirrored cloud then looks like the cloud
 * in a mirror.
 */
export function cloudView(
  viewMatrix: ArrayLike<number>,
  modelMatrix: ArrayLike<number>,
  origin: Vec3,
  isOrthographic: boolean,
): CloudView {
  const m = multiply4(viewMatrix, modelMatrix, modelView);
  const linear = linearPart(m);
  // In float64 about the cloud's origin: far out, float32 would lose millimetres.
  const [x, y, z] = origin;
  const translation = [
    m[0] * x + m[4] * y + m[8] * z + m[12],
    m[1] * x + m[5] * y + m[9] * z + m[13],
    m[2] * x + m[6] * y + m[10] * z + m[14],
  ] as const;
  const inverse = invert3(linear);
  return {
    linear,
    inverse,
    translation,
    camera:
      inverse && !isOrthographic
        ? transform3(inverse, [-translation[0], -translation[1], -translation[2]])
        : null,
    // No direction: callers use FALLBACK_DIRECTION.
    direction: inverse ? transform3(inverse, [0, 0, -1]) : [0, 0, 0],
  };
}
