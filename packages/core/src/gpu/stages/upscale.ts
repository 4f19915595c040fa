import type { ColorTarget } from '../../data/accuracy/accuracy.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { rareSource } from '../shaders/later-source.ts';
import { layerConditions } from './format-conditions.ts';

/** Scales splats blended in a smaller layer to the image's size. Writes depths as r32float. */
export function upscale(colorTarget: ColorTarget, hasDepthLayer: boolean): StageDefinition {
  return computeStage('upscale', {
    source: rareSource('upscale'),
    conditions: { ...layerConditions(colorTarget), DEPTH_LAYER: hasDepthLayer },
  });
}
