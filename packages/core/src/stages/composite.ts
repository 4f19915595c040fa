import type { RenderState, StageDefinition } from '../gpu/pipelines.ts';

/** Composites the blended splats over the background. */
export const composite = {
  stage: 'composite',
  bindings: { parameters: [0, 'uniform'], layer: [1, 'texture'] },
} as const satisfies StageDefinition;

export function compositeState(format: GPUTextureFormat): RenderState {
  return { topology: 'triangle-list', targets: [{ format }] };
}
