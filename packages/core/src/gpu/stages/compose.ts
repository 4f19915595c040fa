import type { RenderState, StageDefinition } from '../pipelines.ts';
import { rareSource } from '../shaders/later-source.ts';
import type { RasterizeDepth } from './rasterize.ts';

/** Formats of compose's targets: linear light, and the splats' depth as the host stores it. */
export const COMPOSED_COLOR_FORMAT = 'rgba16float';
export const COMPOSED_DEPTH_FORMAT = 'r32float';

/**
 * Composes the blended splats over the host's image.
 *
 * @param depth the host's depth, which hides splats; null if there is none.
 * @param isMultisampled whether the host's depth has several samples per pixel: if so, edges of
 *   meshes stay smooth.
 */
export function compose(depth: RasterizeDepth | null, isMultisampled: boolean): StageDefinition {
  const hasDepthLayer = depth !== null && depth.layerFormat !== null;
  return {
    stage: 'compose',
    source: rareSource('compose'),
    conditions: {
      DEPTH_LAYER: hasDepthLayer,
      MULTISAMPLED: isMultisampled,
      DEPTH_LOGARITHMIC: depth?.mapping === 'logarithmic' && !depth.isOrthographic,
      ORTHOGRAPHIC: depth?.isOrthographic === true,
    },
  };
}

export function composeState(depth: RasterizeDepth | null): RenderState {
  const color = { format: COMPOSED_COLOR_FORMAT } as const;
  return {
    topology: 'triangle-list',
    targets: depth?.layerFormat ? [color, { format: COMPOSED_DEPTH_FORMAT }] : [color],
  };
}
