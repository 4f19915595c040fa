import type { ColorTarget } from '../../data/accuracy/accuracy.ts';
import type { DepthConvention } from '../../data/camera/depth-convention.ts';
import { computeStage, type RenderState, type StageDefinition } from '../../gpu/pipelines.ts';
import { layerConditions } from '../format-conditions.ts';
import { depthConditions, type RasterizeDepth, TESTED_DEPTH_FORMAT } from '../quads/quads.ts';

/** Fetched when a frame first needs a stage of the family. */
const later = () => import('./compose.texts.ts');

/** Formats of compose's images: linear light, and the splats' depth as the host stores it. */
export const COMPOSED_COLOR_FORMAT = 'rgba16float';
export const COMPOSED_DEPTH_FORMAT = 'r32float';

/**
 * Composes the blended splats over the host's image.
 *
 * @param depth the host's depth; null if it neither hides splats nor says how to store their own.
 * @param isMultisampled whether the host's depth has several samples per pixel: if so, edges of
 *   meshes stay smooth.
 * @param isFaded whether the splats' picture is blended over the host's in part.
 * @param format of the colours.
 */
export function compose(
  depth: RasterizeDepth | null,
  isMultisampled: boolean,
  isFaded: boolean,
  format: ColorTarget = COMPOSED_COLOR_FORMAT,
): StageDefinition {
  return computeStage('compose', {
    later,
    conditions: {
      ...layerConditions(format),
      MULTISAMPLED: isMultisampled,
      FADED: isFaded,
      ...depthConditions(depth),
    },
  });
}

/**
 * Copies the host's depth under the splats' image: the farthest sample of each pixel.
 *
 * @param isScaled whether splats are blended in a smaller layer, whose pixels take the depth at
 *   their middles.
 */
export function resolveDepth(
  compare: DepthConvention['compare'],
  isMultisampled: boolean,
  isScaled: boolean,
): StageDefinition {
  return {
    stage: 'resolve-depth',
    later,
    conditions: {
      MULTISAMPLED: isMultisampled,
      SCALED: isScaled,
      REVERSED_DEPTH: isMultisampled && compare === 'greater-equal',
    },
  };
}

export const resolveDepthState: RenderState = {
  topology: 'triangle-list',
  targets: [],
  depth: { format: TESTED_DEPTH_FORMAT, depthCompare: 'always', depthWriteEnabled: true },
};

/** Scales splats blended in a smaller layer to the image's size. Writes depths as r32float. */
export function upscale(colorTarget: ColorTarget, hasDepthLayer: boolean): StageDefinition {
  return computeStage('upscale', {
    later,
    conditions: { ...layerConditions(colorTarget), DEPTH_LAYER: hasDepthLayer },
  });
}
