import type { RenderState, StageDefinition } from '../../gpu/pipelines.ts';
import { engineTexts } from '../family-texts.ts';

/** Composites the blended splats over the background. */
export const composite: StageDefinition = {
  stage: 'composite',
  texts: engineTexts,
};

/** Formats of canvases that compute shaders may write. */
export type StorableCanvasFormat = 'bgra8unorm' | 'rgba8unorm';

/** Composites as `composite` does, in a compute shader. */
export function compositeInCompute(format: StorableCanvasFormat): StageDefinition {
  return {
    stage: 'composite',
    texts: engineTexts,
    entryPoint: 'compositePixels',
    conditions: { COMPUTE: true, BGRA: format === 'bgra8unorm' },
  };
}

/** Returns the format if compute shaders of the device may write canvases of it, otherwise null. */
export function storableCanvasFormat(
  device: GPUDevice,
  format: GPUTextureFormat,
): StorableCanvasFormat | null {
  if (format === 'rgba8unorm') return format;
  return format === 'bgra8unorm' && device.features.has('bgra8unorm-storage') ? format : null;
}

export function compositeState(format: GPUTextureFormat): RenderState {
  return { topology: 'triangle-list', targets: [{ format }] };
}
