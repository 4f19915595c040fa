import type { ColorTarget, Extent, RecordPrecision } from '../../data/accuracy/accuracy.ts';
import type { DepthConvention } from '../../data/camera/depth-convention.ts';
import type { RenderState, StageDefinition } from '../../gpu/pipelines.ts';
import { engineTexts } from '../family-texts.ts';
import { recordConditions } from '../format-conditions.ts';

/** Properties of the host's depth that splats drawn into its image, or their own depths, depend on. */
export interface RasterizeDepth {
  readonly mapping: DepthConvention['mapping'];
  readonly compare: DepthConvention['compare'];
  readonly isOrthographic: boolean;
  /** Whether the host's depth hides splats; false: it only says how their own depth is stored. */
  readonly isTested: boolean;
  /** Format of the second target, for the splats' depth; null if that was not requested. */
  readonly layerFormat: DepthLayerFormat | null;
}

/** Formats of the splats' depth: r32float if the device has `float32-blendable`, else r16float. */
export type DepthLayerFormat = 'r32float' | 'r16float';

/** Conditions of linking for stages that read the host's depth. */
export function depthConditions(depth: RasterizeDepth | null) {
  return {
    DEPTH_LOGARITHMIC: depth?.mapping === 'logarithmic' && !depth.isOrthographic,
    ORTHOGRAPHIC: depth?.isOrthographic === true,
    DEPTH_LAYER: depth !== null && depth.layerFormat !== null,
  };
}

/** Variant of the rasterize stage to link. */
export interface RasterizeVariant {
  readonly recordPrecision: RecordPrecision;
  readonly extent: Extent;
  /** The host's depth; null if it is neither tested nor written. */
  readonly depth: RasterizeDepth | null;
  /** Whether splats may be merged ones, with opacities above 1; default false. */
  readonly isStacked?: boolean;
}

/** Format of the depth that splats are tested against. */
export const TESTED_DEPTH_FORMAT = 'depth32float';

/** Draws the visible splats back to front. */
export function rasterize({
  recordPrecision,
  extent,
  depth,
  isStacked = false,
}: RasterizeVariant): StageDefinition {
  return {
    stage: 'rasterize',
    texts: engineTexts,
    conditions: {
      ...recordConditions(recordPrecision),
      FIXED_EXTENT: extent === 'fixed',
      STACKED: isStacked,
      DEPTH_TEST: depth?.isTested === true,
      ...depthConditions(depth),
    },
  };
}

/** Premultiplied "over", tested against the depth buffer, if there is one, without writing to it. */
export function rasterizeState(format: ColorTarget, depth: RasterizeDepth | null): RenderState {
  const over = { srcFactor: 'one', dstFactor: 'one-minus-src-alpha', operation: 'add' } as const;
  const blend = { color: over, alpha: over };
  const formats = depth?.layerFormat ? [format, depth.layerFormat] : [format];
  return {
    topology: 'triangle-strip',
    targets: formats.map((each) => ({ format: each, blend })),
    ...(depth?.isTested && {
      depth: { format: TESTED_DEPTH_FORMAT, depthCompare: depth.compare, depthWriteEnabled: false },
    }),
  };
}
