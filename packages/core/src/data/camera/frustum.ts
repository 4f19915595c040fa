import { stretchBound } from '../math/mat4.ts';
import type { Projection } from './camera.ts';
import type { CloudView } from './cloud-view.ts';

/** A half-space of cloud space: a point is inside if dot(normal, point) + offset ≥ 0. */
export interface FrustumSide {
  readonly normal: readonly [number, number, number];
  readonly offset: number;
  /** A splat's reach across the side, per unit of its largest standard deviation, cloud space. */
  readonly reach: number;
}

/** Most that effects may move and enlarge splats: culling by bounds must not lose these. */
export interface SplatReach {
  /** Largest distance that a centre moves, in the cloud's units. */
  readonly displacement: number;
  /** Largest distance that a centre moves in addition, in world units; default 0. */
  readonly displacementWorld?: number;
  /** Largest factor by which a splat grows, at least 1. */
  readonly growth: number;
  /** @internal Largest standard deviation that a blur adds; default none. */
  readonly blur?: {
    /** World units. */
    readonly atEye: number;
    /** World units in addition per unit of view depth. */
    readonly perDepth: number;
  };
}

/** Rounding that float32 tests of the sides may add, px. */
const MARGIN_PX = 0.5;

/**
 * Returns the six sides (left, right, bottom, top, near, far) of the frustum; a splat outside of
 * any is not drawn. The first four are exact for the affine projection: an ellipse reaches into the
 * image if, linearly in the centre, |x| − depth·tan(edge) is less than the splat's extent and
 * dilation add. At near and far the centre decides.
 *
 * @param alphaCutoff opacity at which a splat ends.
 * @param moved how far effects may move splats and how much they may enlarge them.
 * @param mostOpacity largest opacity of any splat; above 1 for merged ones.
 */
export function frustumSides(
  view: CloudView,
  projection: Projection,
  alphaCutoff: number,
  dilationPx2: number,
  moved: SplatReach = { displacement: 0, growth: 1 },
  mostOpacity = 1,
): readonly FrustumSide[] {
  const { isOrthographic, near, far, focalPx } = projection;
  const stretch = stretchBound(view.linear);
  // Reach of the most opaque splat, in standard deviations: a stack reaches less far than this.
  const opacityReach = Math.sqrt(2 * Math.log(mostOpacity / alphaCutoff));
  const marginPx = opacityReach * Math.sqrt(dilationPx2) + MARGIN_PX;
  // In view space every side is (x, y, z, w): the first four in multiples of x or y and depth = −z.
  const { atEye, perDepth } = moved.blur ?? { atEye: 0, perDepth: 0 };
  // Orthographic cameras may see behind their eye, where blurs grow again.
  const blurAtEye = atEye + 2 * perDepth * Math.max(0, -near);
  const side = (axis: 0 | 1, sign: -1 | 1) => {
    const edges = axis === 0 ? projection.edgesX : projection.edgesY;
    const clamp = axis === 0 ? projection.clampX : projection.clampY;
    /** Least x or y, times `sign`: per unit of depth with perspective. */
    const least = Math.min(sign * edges[0], sign * edges[1]) - marginPx / Math.abs(focalPx[axis]);
    const steepest = isOrthographic ? 0 : Math.max(Math.abs(clamp[0]), Math.abs(clamp[1]));
    const normal: [number, number, number] = [0, 0, 0];
    normal[axis] = sign;
    normal[2] = (isOrthographic ? 0 : least) - opacityReach * perDepth;
    const reach = opacityReach * stretch * Math.sqrt(1 + steepest * steepest);
    const offset = (isOrthographic ? -least : 0) + opacityReach * blurAtEye;
    return sideOf(view, normal, offset, reach, moved);
  };
  return [
    side(0, 1),
    side(0, -1),
    side(1, 1),
    side(1, -1),
    sideOf(view, [0, 0, -1], -near, 0, moved),
    // For an infinite view everything is inside.
    far === Number.POSITIVE_INFINITY
      ? { normal: [0, 0, 0], offset: 0, reach: 0 }
      : sideOf(view, [0, 0, 1], far, 0, moved),
  ];
}

/** @param n normal in view space. */
function sideOf(
  { linear, translation }: CloudView,
  n: readonly number[],
  offset: number,
  reach: number,
  { displacement, growth }: SplatReach,
): FrustumSide {
  const x = n[0] * linear[0] + n[1] * linear[1] + n[2] * linear[2];
  const y = n[0] * linear[3] + n[1] * linear[4] + n[2] * linear[5];
  const z = n[0] * linear[6] + n[1] * linear[7] + n[2] * linear[8];
  const moved = displacement === 0 ? 0 : displacement * Math.hypot(x, y, z);
  return {
    normal: [x, y, z],
    offset: n[0] * translation[0] + n[1] * translation[1] + n[2] * translation[2] + offset + moved,
    reach: reach * growth,
  };
}
