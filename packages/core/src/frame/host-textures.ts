import type { HostPass } from './frame-part.ts';

type HostResource = GPUTexture | number | null | undefined;

/** A bind group with a host's textures: most hosts hand over the same ones in every frame. */
export class HostGroup {
  #group: GPUBindGroup | null = null;
  #of: readonly HostResource[] = [];

  /** Returns the last group, or makes one if that was made for other textures or layers of them. */
  for(resources: readonly HostResource[], make: () => GPUBindGroup): GPUBindGroup {
    if (!this.#group || resources.some((each, i) => each !== this.#of[i])) {
      this.#group = make();
      this.#of = resources;
    }
    return this.#group;
  }

  /** Call when anything else that it binds has changed. */
  clear(): void {
    this.#group = null;
  }
}

/** Creates a view of the layer of a host texture that the pass uses. */
export function layerView(
  texture: GPUTexture,
  { layer = 0 }: HostPass,
  options: GPUTextureViewDescriptor = {},
): GPUTextureView {
  const baseArrayLayer = texture.depthOrArrayLayers > 1 ? layer : 0;
  return texture.createView({ ...options, dimension: '2d', baseArrayLayer, arrayLayerCount: 1 });
}

export function depthView(host: HostPass): GPUTextureView {
  return layerView(host.depth!, host, { aspect: 'depth-only' });
}

export function isMultisampled({ depth }: HostPass): boolean {
  return depth !== null && depth.sampleCount > 1;
}
