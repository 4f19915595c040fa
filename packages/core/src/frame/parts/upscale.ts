import { UpscaleParameters } from '../../data/layout/structs.ts';
import { type ComputePass, dispatchOf } from '../../gpu/passes.ts';
import type { CompiledStage } from '../../gpu/pipelines.ts';
import { upscale } from '../../stages/compose/compose.ts';
import {
  type FramePart,
  type LayerTextures,
  type PartChange,
  type PartContext,
  sizeOverImage,
} from '../frame-part.ts';
import type { FramePlan } from '../frame-plan.ts';
import { type FrameShape, isScaled, perShape } from '../frame-shape.ts';
import { createLayer, fitsLayer, freeLayer } from '../layer-textures.ts';

/** The stage that enlarges the layer to the image's size. */
const stageOf = perShape((shape) => upscale(shape.accuracy.colorTarget, hasDepthLayer(shape)));

function hasDepthLayer({ depth }: FrameShape): boolean {
  return depth?.layerFormat != null;
}

/** Enlarges the blended splats to the image's size if they were blended in a smaller layer. */
export class Upscale implements FramePart {
  /** Null if splats are blended at the image's size. */
  pass: ComputePass | null = null;
  readonly #context: PartContext;
  #image: LayerTextures | null = null;
  #parameters: GPUBuffer | null = null;

  constructor(context: PartContext) {
    this.#context = context;
  }

  static stages(shape: FrameShape): readonly CompiledStage[] {
    return isScaled(shape) ? [stageOf(shape)] : [];
  }

  fit({ request, shape }: FramePlan): PartChange | null {
    const { memory, shared } = this.#context;
    const { colorTarget } = shape.accuracy;
    const depthFormat = hasDepthLayer(shape) ? 'r32float' : null;
    if (!isScaled(shape)) {
      if (!this.#image) return null;
      return { free: () => this.#leave(), make: () => {} };
    }
    if (fitsLayer(this.#image, request, colorTarget, depthFormat)) return null;
    return {
      free: () => {
        freeLayer(memory, this.#image);
        this.#image = null;
      },
      make: () => {
        const { STORAGE_BINDING } = GPUTextureUsage;
        this.#image = createLayer(memory, 'splat layer', request, colorTarget, depthFormat, STORAGE_BINDING);
        shared.image = this.#image;
        const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
        this.#parameters ??= memory.createBuffer('upscale parameters', UpscaleParameters.bytes, usage);
      },
    };
  }

  bind(shape: FrameShape): void {
    const { device, pipelines, shared } = this.#context;
    this.pass = null;
    if (!isScaled(shape)) {
      shared.image = shared.blended;
      return;
    }
    const { color, depthLayer } = shared.blended!;
    const image = this.#image!;
    const layerPerPx = [color.width / image.color.width, color.height / image.color.height];
    const contents = UpscaleParameters.pack({ layerPerPx });
    device.queue.writeBuffer(this.#parameters!, 0, contents);
    const resources = {
      parameters: this.#parameters!,
      layer: color.createView(),
      image: image.color.createView(),
      ...(depthLayer && { depthLayer: depthLayer.createView() }),
      ...(image.depthLayer && { depthImage: image.depthLayer.createView() }),
    };
    const dispatch = dispatchOf(pipelines, stageOf(shape), resources, sizeOverImage(image.color));
    this.pass = { label: 'upscale', timed: 'upscale', dispatches: [dispatch] };
  }

  /** Frees everything, because splats are blended at the image's size. */
  #leave(): void {
    const { memory } = this.#context;
    freeLayer(memory, this.#image);
    this.#image = null;
    if (this.#parameters) memory.destroy(this.#parameters);
    this.#parameters = null;
    this.pass = null;
  }
}
