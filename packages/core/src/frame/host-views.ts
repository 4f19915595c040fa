import type { HostPass } from './frame-part.ts';

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
