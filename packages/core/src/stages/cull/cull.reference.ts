import type { Culling, Extent } from '../../data/accuracy/accuracy.ts';
import type { Projection } from '../../data/camera/camera.ts';
import type { CloudView } from '../../data/camera/cloud-view.ts';
import type { FrustumSide } from '../../data/camera/frustum.ts';
import { CHUNK_SPLATS, SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import type { Vec3 } from '../../data/math/mat4.ts';
import { opacityOf } from '../../data/splats/color-values.ts';
import type { SplatColumns } from '../../data/splats/splat-set.ts';
import { MOTION_VALUES } from '../../features/motion/splat-motion.data.ts';
import {
  rotationMatrix,
  type ScreenCovariance,
  screenCovariance,
  screenRows,
} from '../../reference/covariance.ts';
import type { EffectReference, SplatValues } from '../../reference/effects/effect-reference.ts';
import { reachSquared } from '../../reference/stacked-opacity.ts';

/** Bounds of a chunk of splats, about its cloud's origin. */
export interface ChunkBounds {
  /** Bounds of the centres. */
  readonly minPosition: ArrayLike<number>;
  readonly maxPosition: ArrayLike<number>;
  /** Largest standard deviation along any axis. */
  readonly maxScale: number;
}

/** Reference of cull-chunks: whether the chunk can reach into the image. */
export function isChunkInFrustum(chunk: ChunkBounds, planes: readonly FrustumSide[]): boolean {
  return chunkClearance(chunk, planes) >= 0;
}

/**
 * Clearance of the chunk from the side of the frustum that it is least inside of, relative to the
 * sum of the magnitudes of all terms of that side's test; negative outside. In float32 the sign is
 * certain only away from 0.
 */
export function chunkClearance(
  { minPosition, maxPosition, maxScale }: ChunkBounds,
  planes: readonly FrustumSide[],
): number {
  let clearance = Number.POSITIVE_INFINITY;
  for (const { normal, offset, reach } of planes) {
    let best = offset + reach * maxScale;
    let magnitude = Math.abs(offset) + reach * maxScale;
    for (let axis = 0; axis < 3; axis++) {
      const atMin = normal[axis] * minPosition[axis];
      const atMax = normal[axis] * maxPosition[axis];
      best += Math.max(atMin, atMax);
      magnitude += Math.abs(atMin) + Math.abs(atMax);
    }
    if (magnitude > 0) clearance = Math.min(clearance, best / magnitude);
  }
  return clearance;
}

/** Cutoffs that decide which splats are drawn and how far each reaches. */
export interface CullSettings {
  /** Opacity below which a splat or a fragment is not drawn. */
  readonly alphaCutoff: number;
  /** Variance added to both screen axes, px². */
  readonly dilationPx2: number;
  /** References of the cloud's effects, in the order in which they act; default none. */
  readonly effects?: readonly EffectReference[];
  /** See `VisibleSplat`. */
  readonly isStacked?: boolean;
  /** Default `opacity`. */
  readonly extent?: Extent;
  /** Default `bounding-box`. */
  readonly culling?: Culling;
}

/** A splat that culling kept. */
export interface VisibleSplat {
  /** View depth of the centre, world units. */
  readonly depthView: number;
  readonly centerPx: readonly [number, number];
  readonly covariance: ScreenCovariance;
  /** Peak opacity, 0…1; of a merged splat, the number of opaque ones that it stands for. */
  readonly opacity: number;
  /** Whether an opacity above 1 means a merged splat, as in frames with a cut; default false. */
  readonly isStacked?: boolean;
  /** Half extents, px, of the box of pixels where the opacity, or one of 1, reaches the cutoff. */
  readonly extentPx: readonly [number, number];
}

/** A visible splat with the inputs of its colour. */
export interface CulledSplat extends VisibleSplat {
  /** The splat in its cloud's space, after effects. */
  readonly splat: SplatValues;
  readonly centerView: Vec3;
}

/** FARTHEST_CENTER_PX of cull-splats.wgsl. */
const FARTHEST_CENTER_PX = 1e18;

/**
 * Reference of cull-splats for splat `index` in storage order: the visible splat; null if no part is
 * drawn.
 *
 * @param row where `set` holds it; default `index`.
 */
export function cullSplat(
  set: SplatColumns,
  index: number,
  view: CloudView,
  projection: Projection,
  settings: CullSettings,
  row = index,
): CulledSplat | null {
  const { alphaCutoff, dilationPx2, effects = [], extent = 'opacity' } = settings;
  const splat = changedSplat(set, index, row, effects);
  if (splat.opacity < alphaCutoff) return null;

  const centerView = toView(view, splat.position);
  const depthView = -centerView[2];
  if (!(depthView > projection.near && depthView <= projection.far)) return null;

  const centerPx = toPixels(projection, centerView);
  const rotation = rotationMatrix(...splat.rotation);
  const rows = screenRows(projection, view.linear, centerView, rotation, splat.logScales);
  let covariance = screenCovariance(rows, dilationPx2);
  let { opacity } = splat;
  const onScreen = { covariance, undilated: screenCovariance(rows, 0), dilationPx2, depthView };
  for (const { changeOpacity } of effects) opacity = changeOpacity?.(opacity, onScreen) ?? opacity;
  for (const { changeScreen } of effects) covariance = changeScreen?.(covariance, depthView) ?? covariance;
  if (opacity < alphaCutoff) return null;
  // opacity·exp(−½ xᵀΣ⁻¹x) = cutoff at xᵀΣ⁻¹x = 2·ln(opacity/cutoff); that ellipse's box is √ of
  // Σ's diagonal times that.
  const { isStacked = false } = settings;
  const reach = isStacked
    ? Math.sqrt(2 * reachSquared(extent === 'fixed' ? Math.max(1, opacity) : opacity, alphaCutoff))
    : Math.sqrt(2 * Math.log((extent === 'fixed' ? 1 : opacity) / alphaCutoff));
  const extentPx = [reach * Math.sqrt(covariance.a), reach * Math.sqrt(covariance.c)] as const;
  const isInside =
    settings.culling === 'frustum'
      ? centerPx.every((px) => Math.abs(px) < FARTHEST_CENTER_PX)
      : centerPx[0] + extentPx[0] > 0 &&
        centerPx[0] - extentPx[0] < projection.widthPx &&
        centerPx[1] + extentPx[1] > 0 &&
        centerPx[1] - extentPx[1] < projection.heightPx;
  return isInside
    ? { depthView, centerPx, covariance, opacity, isStacked, extentPx, splat, centerView }
    : null;
}

/** Returns splat `index`, which `set` holds at `row`, after effects. */
function changedSplat(
  set: SplatColumns,
  index: number,
  row: number,
  effects: readonly EffectReference[],
): SplatValues {
  const { positions, rotations, logScales, motion } = set;
  const [at3, at4] = [3 * row, 4 * row];
  let splat: SplatValues = {
    row: set.fileIndices[row],
    position: [positions[at3], positions[at3 + 1], positions[at3 + 2]],
    opacity: opacityOf(set.opacityLogits[row]),
    rotation: [rotations[at4], rotations[at4 + 1], rotations[at4 + 2], rotations[at4 + 3]],
    logScales: [logScales[at3], logScales[at3 + 1], logScales[at3 + 2]],
    ...(motion && { motion: motion.subarray(row * MOTION_VALUES, (row + 1) * MOTION_VALUES) }),
  };
  for (const { changeSplat } of effects) splat = changeSplat?.(splat, index) ?? splat;
  return splat;
}

function toView({ linear, translation }: CloudView, [x, y, z]: Vec3): [number, number, number] {
  return [
    linear[0] * x + linear[3] * y + linear[6] * z + translation[0],
    linear[1] * x + linear[4] * y + linear[7] * z + translation[1],
    linear[2] * x + linear[5] * y + linear[8] * z + translation[2],
  ];
}

function toPixels(projection: Projection, centerView: ArrayLike<number>): [number, number] {
  const { isOrthographic, focalPx, centerPx } = projection;
  const divisor = isOrthographic ? 1 : -centerView[2];
  return [
    centerPx[0] + (focalPx[0] * centerView[0]) / divisor,
    centerPx[1] - (focalPx[1] * centerView[1]) / divisor,
  ];
}

/** Numbers of the chunks whose flag is 1, in storage order. */
export function compactChunks(flags: ArrayLike<number>): number[] {
  return Array.from(flags).flatMap((flag, chunk) => (flag === 1 ? [chunk] : []));
}

/**
 * Reference of compact-splats: numbers of the visible splats in storage order, counted through all
 * chunks of the frame.
 *
 * @param visibleChunks chunk of each slot, ascending.
 * @param visibilityMasks MASK_WORDS words per slot, one bit per splat.
 * @param visibleCapacity most splats to list.
 */
export function compactSplats(
  visibleChunks: ArrayLike<number>,
  visibilityMasks: ArrayLike<number>,
  visibleCapacity: number,
): number[] {
  const visibleSplats: number[] = [];
  for (let slot = 0; slot < visibleChunks.length; slot++) {
    for (let lane = 0; lane < CHUNK_SPLATS; lane++) {
      const word = visibilityMasks[slot * SHADER_CONSTANTS.MASK_WORDS + (lane >> 5)];
      if ((word >>> (lane & 31)) & 1) visibleSplats.push(visibleChunks[slot] * CHUNK_SPLATS + lane);
    }
  }
  return visibleSplats.slice(0, visibleCapacity);
}

/** Chunks of a page, counted through all pages of the frame; `chunkEnd` is the first after it. */
export interface PageChunks {
  readonly chunkStart: number;
  readonly chunkEnd: number;
}

/** Places of a page's visible chunks in the list of all visible chunks. */
export interface PageSlots {
  readonly slotStart: number;
  readonly slotCount: number;
}

/**
 * Reference of plan-cull: distributes the slots of the visible chunks over the pages.
 *
 * @param flags 1 for each visible chunk, 0 for the others.
 * @returns the slots of each page, their number in total, and the numbers of workgroups, one per
 *   slot, that cull the splats of each page and, last, that list the visible splats of all pages.
 */
export function planCull(flags: ArrayLike<number>, pages: readonly PageChunks[]) {
  const visibleChunks = (start: number, end: number) =>
    Array.from(flags)
      .slice(start, end)
      .filter((flag) => flag === 1).length;
  const slots = pages.map(
    ({ chunkStart, chunkEnd }): PageSlots => ({
      slotStart: visibleChunks(0, chunkStart),
      slotCount: visibleChunks(chunkStart, chunkEnd),
    }),
  );
  const slotCount = visibleChunks(0, flags.length);
  return { slots, slotCount, workgroups: [...slots.map((page) => page.slotCount), slotCount] };
}

/** n + 1 exclusive sums of n counts, modulo 2^32, the total last. */
export function prefixScan(counts: ArrayLike<number>): Uint32Array {
  const sums = new Uint32Array(counts.length + 1);
  for (let i = 0; i < counts.length; i++) sums[i + 1] = sums[i] + counts[i];
  return sums;
}
