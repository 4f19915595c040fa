import type { ColorTarget } from '../../data/accuracy/accuracy.ts';
import type { StageDefinition } from '../pipelines.ts';
import { rareSource } from '../shaders/later-source.ts';
import { layerConditions } from './format-conditions.ts';

/** Scales splats blended in a smaller layer to the image's size. Writes depths as r32float. */
export function upscale(colorTarget: ColorTarget, hasDepthLayer: boolean): StageDefinition {
  return {
    stage: 'upscale',
    source: rareSource('upscale'),
    entryPoint: 'upscale',
    conditions: { ...layerConditions(colorTarget), DEPTH_LAYER: hasDepthLayer },
  };
}
