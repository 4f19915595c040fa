// three's internals for passes with several outputs; loaded when one draws splats.
import type { WebGPURenderer } from 'three/webgpu';
import type { RendererInternals, TextureData } from './three-bridge.ts';

/**
 * Returns the texture, with one sample per pixel, of the output with this name of the pass that
 * `renderer` is recording, or null if it has none. Call while the pass is interrupted: `openPass`
 * has probed the internals that are used here.
 */
export function outputTexture(renderer: WebGPURenderer, name: string): GPUTexture | null {
  const { backend, _currentRenderContext: context } = renderer as unknown as RendererInternals;
  const texture = context?.textures?.find((each) => each.name === name);
  return (texture && (backend.get(texture) as TextureData).texture) ?? null;
}
