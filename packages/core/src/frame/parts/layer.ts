import type { ColorTarget, SizePx } from '../../data/accuracy/accuracy.ts';
import { depthMapping } from '../../data/camera/depth-convention.ts';
import { CompositeParameters, HostDepth, UpscaleParameters } from '../../data/layout/structs.ts';
import type { DepthLayerFormat } from '../../stages/quads/quads.ts';
import type { FramePlan } from '../plan/frame-plan.ts';
import { type FrameShape, isScaled } from '../plan/frame-shape.ts';
import type { Drawing, FramePart, PartChange, PartContext } from './frame-part.ts';

/** Textures that splats are blended in, or that blended splats are enlarged into. */
interface LayerTextures {
  /** Premultiplied RGBA in the space that splats are blended in. */
  readonly color: GPUTexture;
  /** View depth weighted like the colours; null if the shape does not need it. */
  readonly depth: GPUTexture | null;
}

/** What textures of a layer have to be. */
interface LayerKind {
  readonly size: SizePx;
  readonly colorTarget: ColorTarget;
  readonly depthFormat: DepthLayerFormat | null;
  readonly usage: GPUTextureUsageFlags;
}

/** The layer that splats are blended in, the image that a smaller one is enlarged into, and their uniforms. */
export class Layer implements FramePart {
  readonly #context: PartContext;
  #layer: LayerTextures | null = null;
  /** Null if splats are blended at the image's size. */
  #image: LayerTextures | null = null;
  #upscaleParameters: GPUBuffer | null = null;
  #compositeParameters: GPUBuffer | null = null;

  constructor(context: PartContext) {
    this.#context = context;
  }

  fit({ layer, request, shape }: FramePlan): PartChange | null {
    const { memory, shared } = this.#context;
    const { resources } = shared;
    const { colorTarget } = shape.accuracy;
    const depthFormat = shape.depth?.layerFormat ?? null;
    const { STORAGE_BINDING } = GPUTextureUsage;
    // Tiles write the same layer as quads.
    const usage = shape.rasterizer === 'tiles' ? STORAGE_BINDING : 0;
    const layerKind = { size: layer, colorTarget, depthFormat, usage };
    const imageKind: LayerKind | null = isScaled(shape)
      ? { size: request, colorTarget, depthFormat: depthFormat && 'r32float', usage: STORAGE_BINDING }
      : null;
    const keepsLayer = fits(this.#layer, layerKind);
    const keepsImage = imageKind ? fits(this.#image, imageKind) : this.#image === null;
    const keepsDepth = (resources.hostDepth != null) === (shape.depth !== null);
    const keepsComposite = this.#compositeParameters !== null || shape.output.kind !== 'canvas';
    if (keepsLayer && keepsImage && keepsDepth && keepsComposite) return null;
    const uniform = (label: string, bytes: number) =>
      memory.createBuffer(label, bytes, GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST);
    return {
      // The frame's size was checked before.
      free: () => {
        if (!keepsLayer) this.#free(this.#layer);
        if (!keepsImage) {
          this.#free(this.#image);
          this.#image = null;
        }
        if (!keepsDepth && resources.hostDepth) memory.destroy(resources.hostDepth);
        if (imageKind || !this.#upscaleParameters) return;
        memory.destroy(this.#upscaleParameters);
        this.#upscaleParameters = null;
      },
      make: () => {
        if (!keepsLayer)
          this.#layer = this.#create(imageKind ? 'small splat layer' : 'splat layer', layerKind);
        if (!keepsDepth) resources.hostDepth = shape.depth && uniform('frame hostDepth', HostDepth.bytes);
        if (!keepsImage && imageKind) this.#image = this.#create('splat layer', imageKind);
        if (imageKind) this.#upscaleParameters ??= uniform('upscale parameters', UpscaleParameters.bytes);
        if (!keepsComposite)
          this.#compositeParameters = uniform('composite parameters', CompositeParameters.bytes);
      },
    };
  }

  bind(shape: FrameShape): void {
    const { device, shared } = this.#context;
    const { color, depth } = this.#layer!;
    const image = this.#image ?? this.#layer!;
    const upscaleParameters = this.#upscaleParameters;
    const compositeParameters = this.#compositeParameters;
    const textures = { layer: color, depthLayer: depth, image: image.color, depthImage: image.depth };
    Object.assign(shared.resources, { ...textures, upscaleParameters, compositeParameters });
    if (!isScaled(shape)) return;
    const layerPerPx = [color.width / image.color.width, color.height / image.color.height];
    device.queue.writeBuffer(upscaleParameters!, 0, UpscaleParameters.pack({ layerPerPx }));
  }

  write(plan: FramePlan): void {
    const { device, shared } = this.#context;
    const { depth } = plan.shape;
    const { hostDepth } = shared.resources;
    if (!hostDepth || !depth) return;
    device.queue.writeBuffer(hostDepth, 0, HostDepth.pack(depthMapping(plan.camera, depth.mapping)));
  }

  aim({ destination }: Drawing): void {
    if (destination.kind !== 'canvas') return;
    const { canvas, background } = destination;
    const { device, shared } = this.#context;
    device.queue.writeBuffer(this.#compositeParameters!, 0, CompositeParameters.pack({ background }));
    // A canvas has another texture in every frame.
    shared.resources.canvas = canvas.getCurrentTexture();
  }

  #create(label: string, { size, colorTarget, depthFormat, usage }: LayerKind): LayerTextures {
    const { memory } = this.#context;
    const extent = { width: size.widthPx, height: size.heightPx };
    return {
      color: memory.createTarget(label, colorTarget, extent, usage),
      depth: depthFormat && memory.createTarget(`${label} depth`, depthFormat, extent, usage),
    };
  }

  #free(layer: LayerTextures | null): void {
    for (const texture of Object.values(layer ?? {})) if (texture) this.#context.memory.destroy(texture);
  }
}

/** Whether `layer` has this size, these formats and at least this usage. */
function fits(layer: LayerTextures | null, { size, colorTarget, depthFormat, usage }: LayerKind): boolean {
  return (
    layer?.color.width === size.widthPx &&
    layer.color.height === size.heightPx &&
    layer.color.format === colorTarget &&
    (layer.depth?.format ?? null) === depthFormat &&
    (layer.color.usage & usage) === usage
  );
}
