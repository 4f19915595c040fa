import type { BindingKind, RenderState, StageDefinition } from '../pipelines.ts';
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
  const bindings: Record<string, readonly [number, BindingKind]> = {
    viewport: [0, 'uniform'],
    layer: [1, 'texture'],
    behind: [2, 'texture'],
  };
  const hasDepthLayer = depth !== null && depth.layerFormat !== null;
  if (hasDepthLayer) bindings.depthLayer = [3, 'texture'];
  if (hasDepthLayer || isMultisampled) bindings.hostDepth = [4, 'uniform'];
  if (isMultisampled) bindings.hostDepths = [5, 'multisampled-depth-texture'];
  return {
    stage: 'compose',
    source: rareSource('compose'),
    conditions: {
      DEPTH_LAYER: hasDepthLayer,
      MULTISAMPLED: isMultisampled,
      DEPTH_LOGARITHMIC: depth?.mapping === 'logarithmic' && !depth.isOrthographic,
      ORTHOGRAPHIC: depth?.isOrthographic === true,
    },
    bindings,
  };
}

export function composeState(depth: RasterizeDepth | null): RenderState {
  const color = { format: COMPOSED_COLOR_FORMAT } as const;
  return {
    topology: 'triangle-list',
    targets: depth?.layerFormat ? [color, { format: COMPOSED_DEPTH_FORMAT }] : [color],
  };
}
