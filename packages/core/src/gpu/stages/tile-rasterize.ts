import type { ColorTarget, RecordPrecision } from '../../data/accuracy/accuracy.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { tileSource } from '../shaders/later-source.ts';
import { layerConditions, recordConditions } from './format-conditions.ts';
import type { RasterizeDepth } from './rasterize.ts';

/** Variant of the tile-rasterize stage to link. */
export interface TileRasterizeVariant {
  readonly recordPrecision: RecordPrecision;
  readonly colorTarget: ColorTarget;
  /** The host's depth; null if nothing can hide a splat. Its layer is r32float, or missing. */
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
/** Threads that blend a tile where each works alone. */
const NARROW_TILE_THREADS = 8;

/** Blends the splats of each tile, front to back. */
export function tileRasterize(variant: TileRasterizeVariant): StageDefinition {
  const { recordPrecision, colorTarget, depth, isExactOrder, isNarrow, isStacked = false } = variant;
  const threads = isNarrow ? NARROW_TILE_THREADS : TILE_THREADS;
  const hasDepthLayer = depth !== null && depth.layerFormat !== null;
  return computeStage('tile-rasterize', {
    source: tileSource('tile-rasterize'),
    constants: { TILE_THREADS: threads, TILE_PIXELS: SHADER_CONSTANTS.TILE_PX ** 2 / threads },
    conditions: {
      NARROW: isNarrow,
      ...recordConditions(recordPrecision),
      ...layerConditions(colorTarget),
      STACKED: isStacked,
      DEPTH_TEST: depth !== null,
      DEPTH_LOGARITHMIC: depth?.mapping === 'logarithmic' && !depth.isOrthographic,
      ORTHOGRAPHIC: depth?.isOrthographic === true,
      REVERSED_DEPTH: depth !== null && depth.compare === 'greater-equal',
      DEPTH_LAYER: hasDepthLayer,
      SHORT_KEYS: depth !== null && !isExactOrder,
    },
  });
}
