import type { Projection } from '../data/camera/camera.ts';
import type { CloudView } from '../data/camera/cloud-view.ts';
import { clampLogScale } from '../data/packing/log-scale.ts';
import type { SplatColumns } from '../data/splats/splat-set.ts';

/** Largest relative error of one float32 rounding. */
export const FLOAT32_ROUNDING = 2 ** -24;

/** Error of denormals that are flushed to zero in the terms of a view coordinate. */
const FLUSHED = 8 * 2 ** -126;

/** Bounds of the GPU's difference from the reference for one splat, derived from its numbers. */
export interface ProjectionErrors {
  /** Bound of the view depth, world units. */
  readonly depthView: number;
  /** Bound of the distance from the camera, world units. */
  readonly distance: number;
  readonly centerPx: readonly [number, number];
  /** Bound of the Frobenius norm of the error of the 2×3 matrix J·V·R·S, px. */
  readonly rowsPx: number;
  /** Bound of the direction in which the splat is seen. */
  readonly direction: number;
}

/**
 * Forward error bounds of float32 arithmetic on float32 uniforms, in units of u = 2^-24.
 *
 * View coordinates: three products and three sums of rounded terms, 6u of the sum M of their
 * magnitudes. Distance: all three view coordinates' errors, and 24u for division (2.5 ulp),
 * squares, sums, root (`inverseSqrt`'s 2 ulp and a division) and product. Centre: its two view
 * coordinates' errors to first order, and 8u for division (2.5 ulp), product, sum and uniforms.
 * Direction: the error of the rounded difference; two unit vectors are never further apart than 2.
 * Rows: relative to R, the longest that a row can be for the splat's largest scale: 96u for
 * rotation (about 8 roundings of a unit quaternion), scale (`exp` of a packed one: 3 + 2|x| ulp),
 * 3×3 product, focal length and tangent, and the depth's relative error twice, once for the scale
 * and once for the tangent.
 */
export function projectionErrors(
  set: SplatColumns,
  index: number,
  view: CloudView,
  projection: Projection,
): ProjectionErrors {
  const u = FLOAT32_ROUNDING;
  const { linear, translation } = view;
  const position = set.positions.subarray(3 * index, 3 * index + 3);
  const center = [0, 1, 2].map(
    (r) =>
      linear[r] * position[0] + linear[3 + r] * position[1] + linear[6 + r] * position[2] + translation[r],
  );
  const errors = [0, 1, 2].map(
    (r) =>
      FLUSHED +
      6 *
        u *
        (Math.abs(linear[r] * position[0]) +
          Math.abs(linear[3 + r] * position[1]) +
          Math.abs(linear[6 + r] * position[2]) +
          Math.abs(translation[r])),
  );
  const { isOrthographic, focalPx, clampX, clampY } = projection;
  const depth = -center[2];
  const divisor = isOrthographic ? 1 : depth;
  const centerError = (axis: 0 | 1) => {
    const focal = Math.abs(focalPx[axis]) / divisor;
    const fromDepth = isOrthographic ? 0 : Math.abs(center[axis] / depth) * errors[2];
    return (
      focal * (errors[axis] + fromDepth) +
      8 * u * (Math.abs(projection.centerPx[axis]) + focal * Math.abs(center[axis]))
    );
  };
  const steepest = isOrthographic ? 0 : Math.max(...[...clampX, ...clampY].map(Math.abs));
  const norm = Math.hypot(...linear);
  const scale = Math.exp(clampLogScale(Math.max(...set.logScales.subarray(3 * index, 3 * index + 3))));
  const longest =
    (Math.max(...focalPx.map(Math.abs)) / divisor) * norm * scale * Math.sqrt(1 + steepest * steepest);
  const relative =
    96 * u + (isOrthographic ? 0 : (2 * errors[2] + Math.max(errors[0], errors[1])) / depth) * 2;
  const toward = view.camera ? Math.hypot(...position.map((p, axis) => p - view.camera![axis])) : 1;
  const far = view.camera ? Math.hypot(...position) + Math.hypot(...view.camera) : 1;
  return {
    depthView: errors[2],
    distance: Math.hypot(...errors) + 24 * u * Math.hypot(...center),
    centerPx: [centerError(0), centerError(1)],
    rowsPx: Math.SQRT2 * longest * relative,
    direction: toward > 0 ? Math.min(2, 8 * u * (1 + far / toward)) : 2,
  };
}
