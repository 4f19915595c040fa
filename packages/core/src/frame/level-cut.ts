import type { Levels } from '../clouds/levels.ts';
import type { AccuracySettings } from '../data/accuracy/accuracy.ts';
import type { Projection } from '../data/camera/camera.ts';
import type { CloudView } from '../data/camera/cloud-view.ts';
import type { SplatReach } from '../data/camera/frustum.ts';
import { LEVEL_CONSTANTS } from '../data/layout/level-structs.ts';
import { type Mat3, stretchBound } from '../data/math/mat4.ts';
import { countInstances } from './cloud-instances.ts';
import type { FixedDetail } from './detail.ts';
import type { CloudInstance } from './frame-request.ts';
import { type SidedCloud, splatsInSight } from './splats-in-sight.ts';

/** The thresholds of a cut through a cloud's levels: fields of `CutParameters`. */
export interface LevelCut {
  readonly camera: readonly [number, number, number];
  readonly squaredPerDistance: number;
  readonly leastSquared: number;
  readonly margin: number;
}

/** Most splats and blobs that a frame's cuts may draw, in all clouds with a cut. */
export interface CutBudget {
  readonly splats: number;
  /** The least shift of thresholds. */
  readonly leastShift: number;
}

/** The cut that allows no error: whatever is finest. */
export const FINEST_CUT: LevelCut = { camera: [0, 0, 0], squaredPerDistance: 0, leastSquared: 0, margin: 0 };

type CutCloud = SidedCloud & { readonly cut: LevelCut | null };

type DrawnInstance = Pick<CloudInstance, 'cloud' | 'instances'>;

/** Error of cuts that only a budget limits, before it shifts them. */
const UNSHIFTED_ERROR_PX = 1;

/** Returns `detail`, or `full` where it limits nothing in a frame of `clouds`. */
export function neededDetail(detail: FixedDetail, clouds: readonly DrawnInstance[]): FixedDetail {
  if (detail === 'full') return detail;
  const { maxErrorPx, ...budget } = detail;
  if (maxErrorPx) return detail;
  const { maxSplats = Number.POSITIVE_INFINITY, maxShare = 1 } = budget;
  return maxShare < 1 || maxSplats < countOf(clouds) ? budget : 'full';
}

function countOf(clouds: readonly DrawnInstance[]): number {
  return clouds.reduce((sum, instance) => sum + instance.cloud.count * countInstances(instance), 0);
}

/**
 * Returns why a frame draws all splats of a cloud, for people; null where it draws a cut through
 * the cloud's levels, which are to be made if there are none.
 */
export function reasonInFull(
  { cloud, instances }: DrawnInstance,
  detail: FixedDetail,
  { inverse }: CloudView,
  { recordPrecision }: Pick<AccuracySettings, 'recordPrecision'>,
): string | null {
  // Of a scene that is not all there, some blobs may be all there is.
  if (cloud.pool) return null;
  if (detail === 'full') return 'full detail is asked for';
  if (cloud.isPreview) return 'the cloud is loading';
  if (cloud.count === 0) return 'the cloud has no splats';
  if (countInstances({ instances }) === 0) return 'the cloud has no instances';
  if (recordPrecision === 'paper') return 'records of 24 bytes hold no opacity above 1';
  if (!inverse) return 'the cloud has no extent';
  return cloud.levelsLack?.message ?? null;
}

/** Returns the budget of a frame's cuts; null where none limits them, or there are none. */
export function cutBudget(detail: FixedDetail, clouds: readonly CutCloud[]): CutBudget | null {
  if (detail === 'full' || !clouds.some(({ cut }) => cut)) return null;
  const { maxErrorPx, maxSplats = Number.POSITIVE_INFINITY, maxShare = 1 } = detail;
  const instances = clouds.map(({ instance }) => instance);
  const limits = [
    ...(maxSplats < countOf(instances) ? [maxSplats] : []),
    ...(maxShare < 1 ? [Math.ceil(maxShare * splatsInSight(clouds))] : []),
  ];
  if (limits.length === 0) return null;
  const inFull = splatsInSight(clouds.filter(({ cut }) => !cut));
  return {
    splats: Math.max(0, Math.min(...limits) - inFull),
    leastShift: maxErrorPx === undefined ? 0 : LEVEL_CONSTANTS.SHIFT_NONE,
  };
}

/** Returns the error of a frame's cuts before a budget shifts it, in pixels; null without a cut. */
export function cutErrorPx(detail: FixedDetail, clouds: readonly Pick<CutCloud, 'cut'>[]): number | null {
  if (detail === 'full' || !clouds.some(({ cut }) => cut)) return null;
  return detail.maxErrorPx ?? UNSHIFTED_ERROR_PX;
}

/**
 * Returns the cut that moves no light by more than `detail` allows, in the middle of the image;
 * null for full detail, for clouds without levels, and where the cloud has no place in space.
 */
export function levelCut(
  levels: Levels | null,
  detail: FixedDetail,
  { linear, inverse, camera }: CloudView,
  { isOrthographic, focalPx, near }: Projection,
  { displacement, growth }: SplatReach,
): LevelCut | null {
  if (!levels || detail === 'full' || !inverse) return null;
  const { largest, smallest } = scaleRange(linear, inverse);
  const { maxErrorPx = UNSHIFTED_ERROR_PX } = detail;
  const radians = maxErrorPx / Math.max(Math.abs(focalPx[0]), Math.abs(focalPx[1])) / growth / largest;
  if (!camera)
    return isOrthographic
      ? { camera: [0, 0, 0], squaredPerDistance: 0, leastSquared: squared(radians), margin: 0 }
      : null;
  return {
    camera,
    squaredPerDistance: squared(radians * smallest),
    // Chunks around the camera are at no distance, but what is nearer than this is not drawn.
    leastSquared: squared(radians * near),
    margin: displacement,
  };
}

/** Within float32's range. */
function squared(value: number): number {
  return Math.min(value ** 2, 1e37);
}

/** How much a linear map stretches lengths, at most and at least. Exact where that is the same. */
function scaleRange(linear: Mat3, inverse: Mat3): { largest: number; smallest: number } {
  const lengths = [0, 3, 6].map((at) => Math.hypot(linear[at], linear[at + 1], linear[at + 2]));
  const scale = Math.max(...lengths);
  const dot = (i: number, j: number) =>
    linear[i] * linear[j] + linear[i + 1] * linear[j + 1] + linear[i + 2] * linear[j + 2];
  const slant = Math.max(Math.abs(dot(0, 3)), Math.abs(dot(0, 6)), Math.abs(dot(3, 6)));
  const isUniform = slant <= 1e-5 * scale ** 2 && Math.min(...lengths) >= (1 - 1e-5) * scale;
  if (isUniform) return { largest: scale, smallest: scale };
  return { largest: stretchBound(linear), smallest: 1 / stretchBound(inverse) };
}
