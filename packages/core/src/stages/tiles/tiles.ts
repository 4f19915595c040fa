import type { ColorTarget, Extent, RecordPrecision } from '../../data/accuracy/accuracy.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import { layerConditions, recordConditions } from '../format-conditions.ts';
import { depthConditions, type RasterizeDepth } from '../quads/quads.ts';
import { type SortShape, sortConstants } from '../sort/sort.ts';

/** `create-engine.ts` fetches these texts earlier, beside the engine. */
const later = () => import('./tiles.texts.ts');

/** Settings that decide which bins and tiles a splat may touch. */
export interface TileListVariant {
  readonly recordPrecision: RecordPrecision;
  readonly extent: Extent;
  /** Whether splats may be merged ones, with opacities above 1; default false. */
  readonly isStacked?: boolean;
  /** The device's `hasNarrowSubgroups`; default false. */
  readonly isNarrow?: boolean;
}

/** Conditions of linking for the stages that list pairs. */
export function tileListConditions({ recordPrecision, extent, isStacked = false }: TileListVariant) {
  return { ...recordConditions(recordPrecision), FIXED_EXTENT: extent === 'fixed', STACKED: isStacked };
}

const { MASK_GROUP, TILE_COUNT_BLOCK } = SHADER_CONSTANTS;
/** Threads of the stages that count and list pairs where few run in lockstep: waiting takes long there. */
const NARROW_LIST_THREADS = 8;
const NARROW_RANK_SAMPLES = 32;

function listConstants({ isNarrow = false }: TileListVariant): StageDefinition['constants'] {
  if (!isNarrow) return {};
  return {
    TILE_WORKGROUP: NARROW_LIST_THREADS,
    TILE_COUNT_ITEMS: TILE_COUNT_BLOCK / NARROW_LIST_THREADS,
    // Longer runs than elsewhere, where neighbours wait for the thread whose run takes longest.
    TILE_EMIT_RUN: 4,
    RANK_SAMPLES: NARROW_RANK_SAMPLES,
    RANK_STEPS: Math.log2(NARROW_RANK_SAMPLES),
  };
}

/**
 * Counts the bins that each visible splat may touch.
 *
 * @param isAgain whether this is the second count, in the larger bins that `tile-plan.wgsl` chose if
 *   the first count did not fit.
 */
export function tileCount(variant: TileListVariant, isAgain = false): StageDefinition {
  return computeStage('tile-count', {
    later,
    conditions: { ...tileListConditions(variant), RECOUNT: isAgain },
    constants: listConstants(variant),
  });
}

/**
 * Decides how large bins are, so that their pairs fit, and sizes the stages that follow.
 *
 * @param isAgain whether to decide once more, if pairs have been counted again.
 */
export function tilePlan(shape: SortShape, isAgain = false): StageDefinition {
  return computeStage('tile-plan', {
    later,
    entryPoint: 'planTiles',
    constants: sortConstants(shape),
    conditions: { RECOUNT: isAgain },
  });
}

/** Lists pairs, and counts the digits of their keys for the first pass of a sort of this shape. */
export function tileEmit(variant: TileListVariant, shape: SortShape): StageDefinition {
  return computeStage('tile-emit', {
    later,
    conditions: tileListConditions(variant),
    constants: { ...sortConstants(shape), ...listConstants(variant) },
  });
}

/** Finds each bin's pairs, and the order of the bins. */
export const tileRanges: StageDefinition = /* @__PURE__ */ computeStage('tile-ranges', {
  later,
  // Bins whose first pairs a thread finds at the same time: two are enough for full HD, eight for 4K.
  constants: { SEARCHES: 4 },
});

/** Finds the tiles that each pair may touch. */
export function tileMasks(variant: TileListVariant): StageDefinition {
  const { isNarrow = false } = variant;
  return computeStage('tile-masks', {
    later,
    entryPoint: 'maskTiles',
    conditions: { ...tileListConditions(variant), NARROW: isNarrow },
    constants: { MASK_WORKGROUP: isNarrow ? MASK_GROUP / 32 : MASK_GROUP },
  });
}

/** Variant of the tile-rasterize stage to link. */
export interface TileRasterizeVariant {
  readonly recordPrecision: RecordPrecision;
  readonly colorTarget: ColorTarget;
  /** The host's depth; null if it is neither tested nor written. Its layer is r32float, or missing. */
  readonly depth: RasterizeDepth | null;
  /** Whether splats come in exact order of depth: a tile then ends at its farthest host depth. */
  readonly isExactOrder: boolean;
  /** Whether few threads of the device run in lockstep: each then reads the splats by itself. */
  readonly isNarrow: boolean;
  /** Whether splats may be merged ones, with opacities above 1; default false. */
  readonly isStacked?: boolean;
}

/** Threads that blend a tile: as many as most GPUs run in lockstep, so that barriers are cheap. */
export const TILE_THREADS = 32;
/** Threads that blend a tile if each works alone. */
const NARROW_TILE_THREADS = 8;

/** Teams of threads that blend the end of a long list: workgroup memory has no room for more. */
const REST_TEAMS = 8;
/** Splats of a tile after which the rest of its list is left to several teams of threads. */
const FRONT_SPLATS = 2048;
/** About as many splats each team takes before the tile may end. */
const ROUND_SPLATS = 128;

/**
 * Whether the ends of long lists are blended by several teams of threads. Not if each thread works alone,
 * nor into a layer of depths, which follow from all that is in front.
 */
export function splitsLists({ depth, isNarrow }: Pick<TileRasterizeVariant, 'depth' | 'isNarrow'>): boolean {
  return !isNarrow && (depth === null || depth.layerFormat === null);
}

/** Blends the splats of each tile, front to back. */
export function tileRasterize(variant: TileRasterizeVariant): StageDefinition {
  return tileStage('tile-rasterize', variant);
}

/** Blends the ends of long lists. Only for variants that split them. */
export function tileRest(variant: TileRasterizeVariant): StageDefinition {
  return tileStage('tile-rest', variant, REST_TEAMS);
}

function tileStage(name: string, variant: TileRasterizeVariant, teams = 1): StageDefinition {
  const { recordPrecision, colorTarget, depth, isExactOrder, isNarrow, isStacked = false } = variant;
  const threads = isNarrow ? NARROW_TILE_THREADS : TILE_THREADS;
  const isTested = depth?.isTested === true;
  return computeStage(name, {
    later,
    constants: {
      TILE_THREADS: threads,
      TILE_PIXELS: SHADER_CONSTANTS.TILE_PX ** 2 / threads,
      // Halvings of a team's threads, and of a word's bits.
      TILE_STEPS: Math.log2(threads),
      BIT_STEPS: 5,
      TILE_TEAMS: teams,
      FRONT_SPLATS,
      ROUND_SPLATS,
    },
    conditions: {
      NARROW: isNarrow,
      SPLIT: splitsLists(variant),
      ...recordConditions(recordPrecision),
      ...layerConditions(colorTarget),
      STACKED: isStacked,
      DEPTH_TEST: isTested,
      REVERSED_DEPTH: depth?.compare === 'greater-equal',
      ...depthConditions(depth),
      SHORT_KEYS: isTested && !isExactOrder,
    },
  });
}
