import type { Vec3 } from '../../data/math/mat4.ts';
import type { ScreenCovariance } from '../covariance.ts';

/** A splat in float64, as effects take and return it: in cloud space, about the cloud's origin. */
export interface SplatValues {
  /** Row of the splat in its file. */
  readonly row: number;
  readonly position: Vec3;
  /** Peak opacity, 0…1. */
  readonly opacity: number;
  /** Quaternion w, x, y, z of any length. */
  readonly rotation: readonly [number, number, number, number];
  /** Natural logarithms of the standard deviations. */
  readonly logScales: Vec3;
  /** Motion of the splat as trained (`MOTION_SLOT`); undefined if it stands still. */
  readonly motion?: ArrayLike<number>;
}

/** A splat on the screen before its opacity is final. */
export interface ScreenValues {
  /** Covariance with dilation. */
  readonly covariance: ScreenCovariance;
  /** Determinant without dilation. */
  readonly undilated: ScreenCovariance;
  readonly dilationPx2: number;
  /** View depth of the centre, world units. */
  readonly depthView: number;
}

/** One effect on one cloud of one frame, in float64: each function is its hook's reference. */
export interface EffectReference {
  /** @param index in storage order. */
  readonly changeSplat?: (splat: SplatValues, index: number) => SplatValues;
  readonly changeOpacity?: (opacity: number, onScreen: ScreenValues) => number;
  /** Returns the covariance that the splat is drawn with. */
  readonly changeScreen?: (covariance: ScreenCovariance, depthView: number) => ScreenCovariance;
  /** @param centerView the splat's centre in view space. */
  readonly changeColor?: (color: Vec3, splat: SplatValues, index: number, centerView: Vec3) => Vec3;
}
