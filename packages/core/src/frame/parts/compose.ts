import { HostViewport } from '../../data/layout/structs.ts';
import type { ComputePass } from '../../gpu/passes.ts';
import type { CompiledStage } from '../../gpu/pipelines.ts';
import { COMPOSED_COLOR_FORMAT, COMPOSED_DEPTH_FORMAT, compose } from '../../stages/compose/compose.ts';
import {
  type Drawing,
  type FramePart,
  type HostPass,
  type PartChange,
  type PartContext,
  sizeOverImage,
} from '../frame-part.ts';
import type { FramePlan } from '../frame-plan.ts';
import { type FrameShape, perShape } from '../frame-shape.ts';
import { depthView, HostGroup, isMultisampled, layerView } from '../host-textures.ts';

/** The splats over the host's image, at the viewport's size. Valid until the view draws again. */
export interface EmbeddedImage {
  /**
   * rgba16float: linear light, premultiplied, over the host's image; opacity is 0 exactly where
   * there is no splat, unless the image was written into the host's (`HostPass.writesColor`).
   */
  readonly color: GPUTexture;
  /**
   * r32float: depth of the splats, in the host's mapping: by tiles the median, by quads the mean;
   * −1 where they cover less than half. Null unless requested.
   */
  readonly depth: GPUTexture | null;
}

/** Two variants: a frame learns the samples of the host's depth only when it is drawn. */
const stageOf = perShape(({ depth, isFaded, output }) => {
  if (output.kind !== 'host') return null;
  return {
    single: compose(depth, false, isFaded),
    many: depth?.isTested ? compose(depth, true, isFaded) : null,
  };
});

/** For the end of a fade, which no shader may delay: splats would vanish while it compiles. */
const stageWithoutFade = perShape((shape) => stageOf({ ...shape, isFaded: false }));

/** Blends the splats over the host's image, in the splats' blending space, for the host to show. */
export class Compose implements FramePart {
  readonly #context: PartContext;
  #viewport: GPUBuffer | null = null;
  #viewportKey = '';
  /** One float32; null until a frame is faded. */
  #fade: GPUBuffer | null = null;
  #image: EmbeddedImage | null = null;
  #behindCopy: GPUTexture | null = null;
  readonly #group = new HostGroup();

  constructor(context: PartContext) {
    this.#context = context;
  }

  static stages(shape: FrameShape): readonly CompiledStage[] {
    const stages = [stageOf(shape), shape.isFaded ? stageWithoutFade(shape) : null];
    return stages.flatMap((each) => Object.values(each ?? {})).filter((stage) => stage !== null);
  }

  /** The last image; null before the first. */
  get image(): EmbeddedImage | null {
    return this.#image;
  }

  /** Leaves the textures to `fitHost`: until a frame is drawn the host may show the old ones. */
  fit({ shape }: FramePlan): PartChange | null {
    const isThere = this.#viewport && (this.#fade || !shape.isFaded);
    if (shape.output.kind !== 'host' || isThere) return null;
    const { memory, shared } = this.#context;
    return {
      free: () => {},
      make: () => {
        const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
        this.#viewport ??= memory.createBuffer('host viewport', HostViewport.bytes, usage);
        if (shape.isFaded) this.#fade ??= memory.createBuffer('fade', 4, usage);
        shared.viewport = this.#viewport;
      },
    };
  }

  write({ request }: FramePlan): void {
    const { fade = 1 } = request;
    if (this.#fade) this.#context.device.queue.writeBuffer(this.#fade, 0, Float32Array.of(fade));
  }

  bind(): void {
    this.#group.clear();
  }

  /** Null unless the destination is a host. */
  pass({ shape, destination }: Drawing): ComputePass | null {
    const stages = stageOf(shape);
    if (!stages || destination.kind !== 'host') return null;
    const { pass: host } = destination;
    const { pipelines, shared } = this.#context;
    const image = this.#image!;
    const isReadable = (host.color.usage & GPUTextureUsage.TEXTURE_BINDING) !== 0;
    const behind = isReadable ? host.color : this.#behindCopy!;
    this.#writeViewport(host, behind, image.color);
    const isEdged = stages.many !== null && isMultisampled(host);
    const stage = isEdged ? stages.many! : stages.single;
    const { color, depthLayer } = shared.image!;
    const { hostDepth } = shared;
    // Whether the depth is read decides between both variants of the stage.
    const group = this.#group.for([behind, host.layer, isEdged ? host.depth : null, image.color], () =>
      pipelines.bindGroup(stage, {
        viewport: this.#viewport!,
        layer: color.createView(),
        behind: isReadable ? layerView(behind, host) : behind.createView(),
        image: image.color.createView(),
        ...(depthLayer && { depthLayer: depthLayer.createView() }),
        ...(image.depth && { depthImage: image.depth.createView() }),
        ...(hostDepth && { hostDepth }),
        ...(shape.isFaded && { fade: this.#fade! }),
        ...(isEdged && { hostDepths: depthView(host) }),
      }),
    );
    return {
      label: 'compose',
      timed: 'composite',
      ...(!isReadable && { copyBefore: between(host, behind, 'from the host') }),
      ...(host.writesColor && { copyAfter: between(host, image.color, 'to the host') }),
      dispatches: [{ pipeline: pipelines.compute(stage)!, group, size: sizeOverImage(image.color) }],
    };
  }

  /** Makes the textures for drawing over `host`. Call before recording. @throws GpuLimitError */
  fitHost(shape: FrameShape, { color: { format, usage } }: HostPass): void {
    const { width, height } = this.#fitImage(shape).color;
    if (usage & GPUTextureUsage.TEXTURE_BINDING || this.#behindCopy?.format === format) return;
    this.#free(this.#behindCopy);
    this.#behindCopy = null;
    this.#behindCopy = this.#context.memory.createTexture({
      label: 'behind the splats',
      size: { width, height },
      format,
      usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
    });
  }

  #fitImage({ depth }: FrameShape): EmbeddedImage {
    const { width, height } = this.#context.shared.image!.color;
    const old = this.#image;
    const isSame =
      old?.color.width === width &&
      old.color.height === height &&
      (old.depth !== null) === (depth?.layerFormat != null);
    if (isSame) return old;
    this.#free(old?.color, old?.depth, this.#behindCopy);
    // No texture that is destroyed may be left where the budget does not allow others.
    this.#image = null;
    this.#behindCopy = null;
    const { STORAGE_BINDING, TEXTURE_BINDING, COPY_SRC } = GPUTextureUsage;
    const create = (label: string, format: GPUTextureFormat) => {
      const usage = STORAGE_BINDING | TEXTURE_BINDING | COPY_SRC;
      return this.#context.memory.createTexture({ label, size: { width, height }, format, usage });
    };
    const color = create('splats over the host', COMPOSED_COLOR_FORMAT);
    this.#image = { color, depth: null };
    if (depth?.layerFormat) {
      this.#image = { color, depth: create('depth of the splats', COMPOSED_DEPTH_FORMAT) };
    }
    return this.#image;
  }

  /** The write comes before the encoder is submitted, so `resolve-depth` sees it too. */
  #writeViewport(
    { color, xPx, yPx, writesColor = false }: HostPass,
    behind: GPUTexture,
    { width, height }: GPUTexture,
  ): void {
    const { device, shared } = this.#context;
    const blended = shared.blended!.color;
    const pxPerLayerPx = [width / blended.width, height / blended.height];
    const key = `${xPx} ${yPx} ${behind === color} ${pxPerLayerPx} ${writesColor}`;
    if (key === this.#viewportKey) return;
    this.#viewportKey = key;
    const contents = HostViewport.pack({
      colorOriginPx: behind === color ? [xPx, yPx] : [0, 0],
      depthOriginPx: [xPx, yPx],
      pxPerLayerPx,
      hasHost: Number(writesColor),
    });
    device.queue.writeBuffer(this.#viewport!, 0, contents);
  }

  #free(...textures: (GPUTexture | null | undefined)[]): void {
    for (const texture of textures) if (texture) this.#context.memory.destroy(texture);
  }
}

/** Copies colours between the host and a texture of the viewport's size; undefined if the viewport misses its target. */
function between(
  { color, xPx, yPx, layer = 0 }: HostPass,
  texture: GPUTexture,
  direction: 'from the host' | 'to the host',
): ComputePass['copyBefore'] {
  // A viewport may reach beyond its target.
  const [left, top] = [Math.max(0, xPx), Math.max(0, yPx)];
  const [right, bottom] = [
    Math.min(color.width, xPx + texture.width),
    Math.min(color.height, yPx + texture.height),
  ];
  if (right <= left || bottom <= top) return undefined;
  const inHost = { texture: color, origin: [left, top, layer] };
  const inTexture = { texture, origin: [left - xPx, top - yPx] };
  const size = [right - left, bottom - top];
  return direction === 'to the host' ? [inTexture, inHost, size] : [inHost, inTexture, size];
}
