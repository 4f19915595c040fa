import {
  invert3,
  linearPart,
  type Mat3,
  multiply4,
  scalesEvenly,
  transform3,
  type Vec3,
} from '../math/mat4.ts';
import { polarDecomposition } from '../math/polar-decomposition.ts';

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
  /**
   * From lines of sight in cloud space to the directions in which harmonics are evaluated,
   * column-major 3×3. The identity, exactly, if the model scales all axes alike.
   */
  readonly sight: Mat3;
  /**
   * Direction in which the camera looks, as harmonics are evaluated; not normalised, and 0 if the
   * model matrix is singular.
   */
  readonly direction: readonly [number, number, number];
}

/** Viewing direction if the camera is at the splat's centre, or the model matrix is singular. */
export const FALLBACK_DIRECTION: Vec3 = [0, 0, 1];

/** Scratch memory. */
const modelView = new Float64Array(16);

const IDENTITY: Mat3 = [1, 0, 0, 0, 1, 0, 0, 0, 1];

/**
 * Returns the cloud as the camera sees it.
 *
 * Harmonics follow KHR_gaussian_splatting: they are turned by the rotation R of the model matrix M,
 * and evaluated along lines of sight in the world. By the polar decomposition M = R·P, the world's
 * direction M·d, turned back by Rᵀ, is P·d: `sight` is P. R is a mirror if M is one, so a mirrored
 * cloud looks like the cloud in a mirror.
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
  const sight = inverse ? sightOf(linearPart(modelMatrix)) : IDENTITY;
  return {
    linear,
    inverse,
    translation,
    sight,
    camera:
      inverse && !isOrthographic
        ? transform3(inverse, [-translation[0], -translation[1], -translation[2]])
        : null,
    // No direction: callers use FALLBACK_DIRECTION.
    direction: inverse ? transform3(sight, transform3(inverse, [0, 0, -1])) : [0, 0, 0],
  };
}

/** The stretch of a model's linear part over its largest entry: directions have no length. */
function sightOf(model: Mat3): Mat3 {
  if (scalesEvenly(model, ROUNDING)) return IDENTITY;
  const stretch = polarDecomposition(model)?.stretch;
  if (!stretch) return IDENTITY;
  const largest = Math.max(...stretch);
  return stretch.map((value) => value / largest);
}

/** Matrices that turn and scale all axes alike differ from that by the rounding of float64 only. */
const ROUNDING = 1e-14;
