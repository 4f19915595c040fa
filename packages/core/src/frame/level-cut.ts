import type { CloudLevels } from '../clouds/cloud-levels.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import type { AccuracySettings } from '../data/accuracy/accuracy.ts';
import type { Projection } from '../data/camera/camera.ts';
import type { CloudView } from '../data/camera/cloud-view.ts';
import type { SplatReach } from '../data/camera/frustum.ts';
import { LEVEL_CONSTANTS } from '../data/layout/level-structs.ts';
import { stretchBound } from '../data/math/mat4.ts';
import { type EffectSet, takesSelection } from '../gpu/effects/effect-set.ts';
import type { Detail, FrameRequest } from './frame-request.ts';

/** The thresholds of a cut through a cloud's levels: fields of `CutParameters`. */
export interface LevelCut {
  readonly camera: readonly [number, number, number];
  readonly squaredPerDistance: number;
  readonly squaredEverywhere: number;
  readonly margin: number;
}

/** Most splats and blobs that a frame's cuts may draw, in all clouds with a cut. */
export interface CutBudget {
  readonly splats: number;
  /** The least shift of thresholds. */
  readonly leastShift: number;
}

/** Error of cuts that only a budget limits, before it shifts them. */
const UNSHIFTED_ERROR_PX = 1;

/** The detail of a frame: full where all splats are within its budget, or no error is allowed. */
export function detailOf({ detail = 'full', clouds }: Pick<FrameRequest, 'detail' | 'clouds'>): Detail {
  if (detail === 'full' || detail.maxErrorPx) return detail;
  const total = clouds.reduce((sum, { cloud }) => sum + cloud.count, 0);
  const { maxSplats = total } = detail;
  return maxSplats >= total ? 'full' : { maxSplats };
}

/**
 * Returns why a frame draws all splats of a cloud, for people; null where it draws a cut through
 * the cloud's levels, which are to be made if there are none.
 */
export function reasonInFull(
  cloud: SplatCloud,
  detail: Detail,
  effects: EffectSet,
  { inverse }: CloudView,
  { recordPrecision }: Pick<AccuracySettings, 'recordPrecision'>,
): string | null {
  if (detail === 'full') return 'full detail is asked for';
  if (cloud.isPreview) return 'the cloud is loading';
  if (cloud.count === 0) return 'the cloud has no splats';
  if (cloud.editing) return 'the cloud was edited';
  if (recordPrecision === 'paper') return 'records of 24 bytes hold no opacity above 1';
  // Rows of blobs are not known.
  if (takesSelection(effects, ['splat', 'color'])) return 'an effect shows a selection of splats';
  if (!inverse) return 'the cloud has no extent';
  return cloud.levelsLack?.message ?? null;
}

/** Returns the budget of a frame's cuts; null where none limits them, or there are none. */
export function cutBudget(
  detail: Detail,
  clouds: readonly { readonly cut: LevelCut | null; readonly count: number }[],
): CutBudget | null {
  if (detail === 'full' || detail.maxSplats === undefined || !clouds.some(({ cut }) => cut)) return null;
  const total = clouds.reduce((sum, { count }) => sum + count, 0);
  if (total <= detail.maxSplats) return null;
  const inFull = clouds.reduce((sum, { cut, count }) => (cut ? sum : sum + count), 0);
  return {
    splats: Math.max(0, detail.maxSplats - inFull),
    leastShift: detail.maxErrorPx === undefined ? 0 : LEVEL_CONSTANTS.SHIFT_NONE,
  };
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
  const { maxErrorPx = UNSHIFTED_ERROR_PX } = detail;
  const radians = maxErrorPx / Math.max(Math.abs(focalPx[0]), Math.abs(focalPx[1])) / growth / largest;
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
