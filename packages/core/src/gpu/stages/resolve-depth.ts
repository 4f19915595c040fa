import type { DepthConvention } from '../../data/camera/depth-convention.ts';
import type { RenderState, StageDefinition } from '../pipelines.ts';
import { rareSource } from '../shaders/later-source.ts';
import { TESTED_DEPTH_FORMAT } from './rasterize.ts';

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
    source: rareSource('resolve-depth'),
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
