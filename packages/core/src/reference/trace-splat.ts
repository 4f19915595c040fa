import { DILATION_PX2 } from '../data/accuracy/accuracy.ts';
import { type Camera, projectionOf } from '../data/camera/camera.ts';
import { cloudView } from '../data/camera/cloud-view.ts';
import { identity4, type Vec3 } from '../data/math/mat4.ts';
import type { Harmonics } from '../data/packing/harmonics.ts';
import type { ShDegree, SplatSet } from '../data/splats/splat-set.ts';
import { cullSplat } from '../stages/cull/cull.reference.ts';
import { splatColor } from '../stages/project/project.reference.ts';
import { screenAxes } from './covariance.ts';

/** The frame that a splat is traced in. */
export interface TraceOptions {
  readonly camera: Camera;
  /** Size of the image. */
  readonly widthPx: number;
  readonly heightPx: number;
  /** Cloud to world, column-major; default the identity. */
  readonly modelMatrix?: ArrayLike<number>;
  /** Opacity at which splats end; default 1/255. */
  readonly alphaCutoff?: number;
}

/** A splat seen from a camera, without effects. Pixels from the image's top left, y down. */
export interface TracedSplat {
  /** View depth of the centre, world units. */
  readonly depthView: number;
  readonly centerPx: readonly [number, number];
  /** Half axes of the ellipse at whose edge the opacity has fallen to the cutoff. */
  readonly majorPx: readonly [number, number];
  readonly minorPx: readonly [number, number];
  /** sRGB-encoded red, green, blue, 0 or more, at each SH degree from 0 to the degree of the set. */
  readonly colors: readonly Vec3[];
}

/**
 * Computes how splat `index` of `set` is seen, in float64. It need not be within the image.
 *
 * @returns null if it cannot be seen: fainter than the cutoff, nearer than the camera's near plane,
 *   or beyond its far plane.
 */
export function traceSplat(
  set: SplatSet<Harmonics>,
  index: number,
  options: TraceOptions,
): TracedSplat | null {
  const { camera, widthPx, heightPx, modelMatrix = identity4(), alphaCutoff = 1 / 255 } = options;
  const projection = projectionOf(camera, widthPx, heightPx);
  const view = cloudView(camera.viewMatrix, modelMatrix, set.origin, projection.isOrthographic);
  const settings = { alphaCutoff, dilationPx2: DILATION_PX2, culling: 'frustum' } as const;
  const seen = cullSplat(set, index, view, projection, settings);
  if (!seen) return null;
  const { depthView, centerPx, opacity, covariance } = seen;
  const { majorPx, minorPx } = screenAxes(covariance);
  // Axes end where the Gaussian has fallen to 1/e.
  const reach = Math.sqrt(Math.log(opacity / alphaCutoff));
  const scaled = ([x, y]: readonly [number, number]) => [reach * x, reach * y] as const;
  const colors = Array.from({ length: set.harmonics.degree + 1 }, (_, degree) =>
    splatColor(set, index, view, degree as ShDegree, seen),
  );
  return { depthView, centerPx, majorPx: scaled(majorPx), minorPx: scaled(minorPx), colors };
}
