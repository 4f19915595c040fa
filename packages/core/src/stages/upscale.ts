import type { ColorTarget } from '../accuracy/accuracy.ts';
import type { BindingKind, RenderState, StageDefinition } from '../gpu/pipelines.ts';
import { rareSource } from '../shaders/later-source.ts';
import type { DepthLayerFormat } from './rasterize.ts';

/** Scales splats that were blended in a smaller layer to the image's size. */
export function upscale(hasDepthLayer: boolean): StageDefinition {
  const bindings: Record<string, readonly [number, BindingKind]> = {
    parameters: [0, 'uniform'],
    layer: [1, 'texture'],
  };
  if (hasDepthLayer) bindings.depthLayer = [2, 'texture'];
  return {
    stage: 'upscale',
    source: rareSource('upscale'),
    conditions: { DEPTH_LAYER: hasDepthLayer },
    bindings,
  };
}

export function upscaleState(format: ColorTarget, depthFormat: DepthLayerFormat | null): RenderState {
  const formats = depthFormat ? [format, depthFormat] : [format];
  return { topology: 'triangle-list', targets: formats.map((each) => ({ format: each })) };
}
