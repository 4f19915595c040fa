import type { ColorTarget } from '../../data/accuracy/accuracy.ts';
import type { BindingKind, StageDefinition } from '../pipelines.ts';
import { rareSource } from '../shaders/later-source.ts';
import { layerConditions } from './format-conditions.ts';

/** Scales splats blended in a smaller layer to the image's size. Writes depths as r32float. */
export function upscale(colorTarget: ColorTarget, hasDepthLayer: boolean): StageDefinition {
  const bindings: Record<string, readonly [number, BindingKind]> = {
    parameters: [0, 'uniform'],
    layer: [1, 'texture'],
    image: [2, `${colorTarget} writes`],
  };
  if (hasDepthLayer) {
    bindings.depthLayer = [3, 'texture'];
    bindings.depthImage = [4, 'r32float writes'];
  }
  return {
    stage: 'upscale',
    source: rareSource('upscale'),
    entryPoint: 'upscale',
    conditions: { ...layerConditions(colorTarget), DEPTH_LAYER: hasDepthLayer },
    bindings,
  };
}
