import type { CloudLevels } from '../clouds/cloud-levels.ts';
import type { Projection } from '../data/camera/camera.ts';
import type { CloudView } from '../data/camera/cloud-view.ts';
import type { SplatReach } from '../data/camera/frustum.ts';
import { stretchBound } from '../data/math/mat4.ts';
import type { Detail } from './frame-request.ts';

/** The thresholds of a cut through a cloud's levels: fields of `CutParameters`. */
export interface LevelCut {
  readonly camera: readonly [number, number, number];
  readonly squaredPerDistance: number;
  readonly squaredEverywhere: number;
  readonly margin: number;
}

/**
 * Returns the cut that moves no light by more than `detail` allows, in the middle of the image;
 * null for full detail, for clouds without levels, and where the cloud has no place in space.
 */
export function levelCut(
  levels: CloudLevels | null,
  detail: Detail,
  { linear, inverse, camera }: CloudView,
  { isOrthographic, focalPx }: Projection,
  { displacement, growth }: SplatReach,
): LevelCut | null {
  if (!levels || detail === 'full' || !inverse) return null;
  const { largest, smallest } = scaleRange(linear, inverse);
  const radians = detail.maxErrorPx / Math.max(Math.abs(focalPx[0]), Math.abs(focalPx[1])) / growth / largest;
  if (!camera)
    return isOrthographic
      ? { camera: [0, 0, 0], squaredPerDistance: 0, squaredEverywhere: squared(radians), margin: 0 }
      : null;
  return {
    camera,
    squaredPerDistance: squared(radians * smallest),
    squaredEverywhere: 0,
    margin: displacement,
  };
}

/** Within float32's range. */
function squared(value: number): number {
  return Math.min(value ** 2, 1e37);
}

/** How much a linear map stretches lengths, at most and at least. Exact where that is the same. */
function scaleRange(linear: Float64Array, inverse: Float64Array): { largest: number; smallest: number } {
  const lengths = [0, 3, 6].map((at) => Math.hypot(linear[at], linear[at + 1], linear[at + 2]));
  const scale = Math.max(...lengths);
  const dot = (i: number, j: number) =>
    linear[i] * linear[j] + linear[i + 1] * linear[j + 1] + linear[i + 2] * linear[j + 2];
  const slant = Math.max(Math.abs(dot(0, 3)), Math.abs(dot(0, 6)), Math.abs(dot(3, 6)));
  const isUniform = slant <= 1e-5 * scale ** 2 && Math.min(...lengths) >= (1 - 1e-5) * scale;
  if (isUniform) return { largest: scale, smallest: scale };
  return { largest: stretchBound(linear), smallest: 1 / stretchBound(inverse) };
}
