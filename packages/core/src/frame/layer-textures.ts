import type { ColorTarget, SizePx } from '../data/accuracy/accuracy.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { DepthLayerFormat } from '../stages/quads/quads.ts';
import type { LayerTextures } from './frame-part.ts';

/** Whether `layer` has this size, these formats and at least this usage. */
export function fitsLayer(
  layer: LayerTextures | null,
  { widthPx, heightPx }: SizePx,
  colorTarget: ColorTarget,
  depthFormat: DepthLayerFormat | null,
  usage: GPUTextureUsageFlags = 0,
): boolean {
  return (
    layer?.color.width === widthPx &&
    layer.color.height === heightPx &&
    layer.color.format === colorTarget &&
    (layer.depthLayer?.format ?? null) === depthFormat &&
    (layer.color.usage & usage) === usage
  );
}

export function createLayer(
  memory: GpuMemory,
  label: string,
  { widthPx, heightPx }: SizePx,
  colorTarget: ColorTarget,
  depthFormat: DepthLayerFormat | null,
  usage: GPUTextureUsageFlags = 0,
): LayerTextures {
  const size = { width: widthPx, height: heightPx };
  return {
    color: memory.createTarget(label, colorTarget, size, usage),
    depthLayer: depthFormat && memory.createTarget(`${label} depth`, depthFormat, size, usage),
  };
}

export function freeLayer(memory: GpuMemory, layer: LayerTextures | null): void {
  if (!layer) return;
  memory.destroy(layer.color);
  if (layer.depthLayer) memory.destroy(layer.depthLayer);
}
