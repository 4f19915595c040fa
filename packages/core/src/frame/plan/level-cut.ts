import type { Levels } from '../../clouds/levels/levels.ts';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import type { AccuracySettings } from '../../data/accuracy/accuracy.ts';
import type { Projection } from '../../data/camera/camera.ts';
import type { CloudView } from '../../data/camera/cloud-view.ts';
import type { FrustumSide, SplatReach } from '../../data/camera/frustum.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { type Mat3, stretchBound } from '../../data/math/mat4.ts';
import { countChunksInFrustum } from './chunk-groups.ts';
import { countInstances } from './cloud-instances.ts';
import type { FixedDetail } from './detail.ts';
import type { CloudInstance } from './frame-request.ts';

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

/** The cut without error: it draws the finest level that is present. */
export const FINEST_CUT: LevelCut = { camera: [0, 0, 0], squaredPerDistance: 0, leastSquared: 0, margin: 0 };

type CutCloud = SidedCloud & { readonly cut: LevelCut | null };

type DrawnInstance = Pick<CloudInstance, 'cloud' | 'instances'>;

/** Error of cuts that only a budget limits, before it shifts them. */
const UNSHIFTED_ERROR_PX = 1;

/** Returns `detail`, or `full` if it limits nothing in a frame of `clouds`. */
export function neededDetail(detail: FixedDetail, clouds: readonly DrawnInstance[]): FixedDetail {
  if (detail === 'full') return detail;
  const { maxErrorPx, ...budget } = detail;
  if (maxErrorPx) return detail;
  const { maxSplats = Number.POSITIVE_INFINITY, maxShare = 1 } = budget;
  return maxShare < 1 || maxSplats < countOf(clouds) ? budget : 'full';
}

/** Returns the share of these clouds' splats that `splats` are. */
export function shareOf(splats: number, clouds: readonly DrawnInstance[]): number {
  return splats / Math.max(splats, countOf(clouds));
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
  if (cloud.timeRange) return 'the cloud moves';
  if (cloud.count === 0) return 'the cloud has no splats';
  if (countInstances({ instances }) === 0) return 'the cloud has no instances';
  if (recordPrecision === 'paper') return 'records of 24 bytes hold no opacity above 1';
  if (!inverse) return 'the cloud has no extent';
  return cloud.levelsLack?.message ?? null;
}

/** Returns the budget of a frame's cuts; null if none limits them, or there are none. */
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
 * Returns the cut that moves no light by more than `detail` allows, in the middle of the image; null
 * for full detail and for clouds without levels.
 *
 * @param leastDepth of all splats, for a place where the cloud has no extent, and so no distances.
 */
export function levelCut(
  levels: Levels | null,
  detail: FixedDetail,
  { linear, inverse, camera }: CloudView,
  { isOrthographic, focalPx, near }: Projection,
  { displacement, growth }: SplatReach,
  leastDepth = 0,
): LevelCut | null {
  if (!levels || detail === 'full') return null;
  const { maxErrorPx = UNSHIFTED_ERROR_PX } = detail;
  const { largest, smallest } = scaleRange(linear, inverse);
  const radians = maxErrorPx / Math.max(Math.abs(focalPx[0]), Math.abs(focalPx[1])) / growth / largest;
  return {
    camera: camera ?? [0, 0, 0],
    squaredPerDistance: camera ? squared(radians * smallest) : 0,
    // Chunks around the camera have distance 0; use the near plane, before which nothing is drawn.
    leastSquared: squared(isOrthographic ? radians : radians * Math.max(near, leastDepth)),
    margin: camera ? displacement : 0,
  };
}

/** Returns the least depth of the bounds of a cloud's splats, which may be behind the camera. */
export function nearestDepth(
  { bounds: { min, max }, origin }: Pick<SplatCloud, 'bounds' | 'origin'>,
  { linear, translation }: CloudView,
): number {
  return [0, 1, 2].reduce((depth, axis) => {
    const weight = -linear[3 * axis + 2];
    return depth + weight * ((weight > 0 ? min : max)[axis] - origin[axis]);
  }, -translation[2]);
}

/** Within float32's range. */
function squared(value: number): number {
  return Math.min(value ** 2, 1e37);
}

/** How much a linear map stretches lengths, at most and at least. Exact if both are the same. */
function scaleRange(linear: Mat3, inverse: Mat3 | null): { largest: number; smallest: number } {
  const [a, b, c] = [dot(linear, 0, 0), dot(linear, 3, 3), dot(linear, 6, 6)];
  const largest2 = Math.max(a, b, c);
  const slant = Math.max(
    Math.abs(dot(linear, 0, 3)),
    Math.abs(dot(linear, 0, 6)),
    Math.abs(dot(linear, 3, 6)),
  );
  const isUniform = slant <= 1e-5 * largest2 && Math.min(a, b, c) >= (1 - 2e-5) * largest2;
  if (isUniform && inverse) return { largest: Math.sqrt(largest2), smallest: Math.sqrt(largest2) };
  return { largest: stretchBound(linear), smallest: inverse ? 1 / stretchBound(inverse) : 0 };
}

/** Product of two columns, which begin at these places. */
function dot(m: Mat3, i: number, j: number): number {
  return m[i] * m[j] + m[i + 1] * m[j + 1] + m[i + 2] * m[j + 2];
}

/** A cloud of a frame, with the sides of the frustum in its space. */
interface SidedCloud {
  readonly instance: Pick<CloudInstance, 'cloud' | 'time'>;
  readonly sides: readonly FrustumSide[];
  /** Frustum sides per instance; null, the default, if the cloud is drawn once. */
  readonly places?: readonly { readonly sides: readonly FrustumSide[] }[] | null;
}

/** Returns the splats of all chunks that may reach into the image: never less than are drawn. */
export function splatsInSight(clouds: readonly SidedCloud[]): number {
  const ofPlace = ({ cloud, time }: SidedCloud['instance'], sides: readonly FrustumSide[]) => {
    const moving = cloud.features.find(({ chunksAt }) => chunksAt);
    const chunks = moving?.chunksAt?.(cloud.chunks, time) ?? cloud.chunks;
    return Math.min(cloud.count, CHUNK_SPLATS * countChunksInFrustum(chunks, sides));
  };
  return clouds.reduce(
    (sum, { instance, sides, places }) =>
      (places ?? [{ sides }]).reduce((total, place) => total + ofPlace(instance, place.sides), sum),
    0,
  );
}
