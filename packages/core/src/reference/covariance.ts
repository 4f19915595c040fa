import type { Projection } from '../data/camera/camera.ts';
import { clampLogScale } from '../data/packing/log-scale.ts';

/** Covariance of a splat on the screen, px², y down: [[a, b], [b, c]]; its determinant, px⁴. */
export interface ScreenCovariance {
  readonly a: number;
  readonly b: number;
  readonly c: number;
  readonly determinant: number;
}

/** Half axes of an ellipse at √2 standard deviations, where the Gaussian is 1/e; px, y down. */
export interface ScreenAxes {
  readonly majorPx: readonly [number, number];
  readonly minorPx: readonly [number, number];
}

/** Row-major rotation matrix of quaternion w, x, y, z of any length; the identity for length 0. */
export function rotationMatrix(w: number, x: number, y: number, z: number): number[] {
  const largest = Math.max(Math.abs(w), Math.abs(x), Math.abs(y), Math.abs(z));
  if (largest === 0) return [1, 0, 0, 0, 1, 0, 0, 0, 1];
  const [p, q, r, s] = [w / largest, x / largest, y / largest, z / largest];
  const k = 2 / (p * p + q * q + r * r + s * s);
  return [
    1 - k * (r * r + s * s),
    k * (q * r - p * s),
    k * (q * s + p * r),
    k * (q * r + p * s),
    1 - k * (q * q + s * s),
    k * (r * s - p * q),
    k * (q * s - p * r),
    k * (r * s + p * q),
    1 - k * (q * q + r * r),
  ];
}

/**
 * Rows of J·V·R·S: the splat's local axes, one standard deviation long, projected to the screen.
 *
 * @param viewLinear linear part of model to view, column-major 3×3.
 * @param centerView centre in view space.
 * @returns six numbers: the row for x (px), then the row for y (px, down).
 */
export function screenRows(
  projection: Projection,
  viewLinear: ArrayLike<number>,
  centerView: ArrayLike<number>,
  rotation: ArrayLike<number>,
  logScales: ArrayLike<number>,
): number[] {
  const depth = -centerView[2];
  const { isOrthographic, focalPx, clampX, clampY } = projection;
  const scaleX = isOrthographic ? focalPx[0] : focalPx[0] / depth;
  const scaleY = isOrthographic ? focalPx[1] : focalPx[1] / depth;
  const tangentX = isOrthographic ? 0 : clamp(centerView[0] / depth, clampX);
  const tangentY = isOrthographic ? 0 : clamp(centerView[1] / depth, clampY);
  const rows = new Array<number>(6);
  for (let axis = 0; axis < 3; axis++) {
    const scale = Math.exp(clampLogScale(logScales[axis]));
    const [x, y, z] = [0, 1, 2].map(
      (r) =>
        scale *
        (viewLinear[r] * rotation[axis] +
          viewLinear[3 + r] * rotation[3 + axis] +
          viewLinear[6 + r] * rotation[6 + axis]),
    );
    rows[axis] = scaleX * (x + tangentX * z);
    rows[3 + axis] = -scaleY * (y + tangentY * z);
  }
  return rows;
}

/** Covariance on the screen from the rows of J·V·R·S, with `dilationPx2` added to both axes. */
export function screenCovariance(rows: ArrayLike<number>, dilationPx2: number): ScreenCovariance {
  const [x0, x1, x2, y0, y1, y2] = Array.from(rows);
  const xx = x0 * x0 + x1 * x1 + x2 * x2;
  const yy = y0 * y0 + y1 * y1 + y2 * y2;
  const crossX = x1 * y2 - x2 * y1;
  const crossY = x2 * y0 - x0 * y2;
  const crossZ = x0 * y1 - x1 * y0;
  return {
    a: xx + dilationPx2,
    b: x0 * y0 + x1 * y1 + x2 * y2,
    c: yy + dilationPx2,
    // By Lagrange's identity the determinant is a sum of non-negative terms: nothing cancels.
    determinant:
      crossX * crossX +
      crossY * crossY +
      crossZ * crossZ +
      dilationPx2 * (xx + yy) +
      dilationPx2 * dilationPx2,
  };
}

export function screenAxes({ a, b, c, determinant }: ScreenCovariance): ScreenAxes {
  const larger = (a + c) / 2 + Math.hypot((a - c) / 2, b);
  const smaller = determinant / larger;
  // Both are eigenvectors of the larger eigenvalue; the longer one is better conditioned.
  const candidates: [number, number][] = [
    [b, larger - a],
    [larger - c, b],
  ];
  const lengths = candidates.map(([x, y]) => Math.hypot(x, y));
  const best = lengths[0] > lengths[1] ? 0 : 1;
  // Both vanish for a circle; its axes may point anywhere.
  const direction = lengths[best] > 0 ? candidates[best].map((v) => v / lengths[best]) : [1, 0];
  const majorLength = Math.sqrt(2 * larger);
  const minorLength = Math.sqrt(2 * smaller);
  return {
    majorPx: [majorLength * direction[0], majorLength * direction[1]],
    minorPx: [-minorLength * direction[1], minorLength * direction[0]],
  };
}

function clamp(value: number, [low, high]: readonly [number, number]): number {
  return Math.max(low, Math.min(high, value));
}
