import type { ColorTarget, RecordPrecision } from '../accuracy/accuracy.ts';
import type { BindingKind, StageDefinition } from '../gpu/pipelines.ts';
import type { RasterizeDepth } from './rasterize.ts';
import { recordConditions } from './record-conditions.ts';

/** Variant of the tile-rasterize stage to link. */
export interface TileRasterizeVariant {
  readonly recordPrecision: RecordPrecision;
  readonly colorTarget: ColorTarget;
  /** The host's depth; null if nothing can hide a splat. Its layer's format is r32float, or there is none. */
  readonly depth: RasterizeDepth | null;
  /** Whether splats come in exact order of depth: a tile then ends at its farthest host depth. */
  readonly isExactOrder: boolean;
}

/** Blends the splats of each tile, front to back. */
export function tileRasterize(variant: TileRasterizeVariant): StageDefinition {
  const { recordPrecision, colorTarget, depth, isExactOrder } = variant;
  const bindings: Record<string, readonly [number, BindingKind]> = {
    view: [0, 'uniform'],
    grid: [1, 'uniform'],
    binStarts: [3, 'read'],
    binOrder: [4, 'read'],
    tileMasks: [5, 'read'],
    sortedRecords: [6, 'read'],
    records: [7, 'read'],
    layer: [8, `${colorTarget} writes`],
  };
  if (depth) {
    bindings.hostDepth = [9, 'uniform'];
    bindings.testedDepth = [10, 'depth-texture'];
  }
  const hasDepthLayer = depth !== null && depth.layerFormat !== null;
  if (hasDepthLayer) bindings.depthLayer = [11, 'r32float writes'];
  return {
    stage: 'tile-rasterize',
    entryPoint: 'tileRasterize',
    conditions: {
      ...recordConditions(recordPrecision),
      LAYER_F32: colorTarget === 'rgba32float',
      LAYER_F16: colorTarget === 'rgba16float',
      DEPTH_TEST: depth !== null,
      DEPTH_LOGARITHMIC: depth?.mapping === 'logarithmic' && !depth.isOrthographic,
      ORTHOGRAPHIC: depth?.isOrthographic === true,
      REVERSED_DEPTH: depth !== null && depth.compare === 'greater-equal',
      DEPTH_LAYER: hasDepthLayer,
      SHORT_KEYS: depth !== null && !isExactOrder,
    },
    bindings,
  };
}
