import { HostViewport } from '../../data/layout/structs.ts';
import type { ComputePass } from '../../gpu/passes.ts';
import { COMPOSED_COLOR_FORMAT, COMPOSED_DEPTH_FORMAT } from '../../stages/compose/compose.ts';
import { TESTED_DEPTH_FORMAT } from '../../stages/quads/quads.ts';
import type { FramePlan } from '../plan/frame-plan.ts';
import type { FrameShape } from '../plan/frame-shape.ts';
import type {
  Destination,
  Drawing,
  FramePart,
  FrameResources,
  HostPass,
  PartChange,
  PartContext,
} from './frame-part.ts';

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

/**
 * Textures for drawing inside another renderer's frame: the host's image and depth, a copy of the depth
 * for splats to be tested against (it may be multisampled, larger, or in another format), and the image
 * of splats over the host's. Made only when a frame is drawn: until then the host may show the last ones.
 */
export class HostTextures implements FramePart {
  readonly #context: PartContext;
  /** The last image; null before the first. */
  image: EmbeddedImage | null = null;
  #viewport: GPUBuffer | null = null;
  #viewportKey = '';
  /** One float32; null until a frame is faded. */
  #fade: GPUBuffer | null = null;
  #behindCopy: GPUTexture | null = null;
  readonly #views = { behind: new LayerView(), depth: new LayerView('depth-only') };

  constructor(context: PartContext) {
    this.#context = context;
  }

  /** Bytes of the copy of the host's depth. */
  get testedDepthBytes(): number {
    return this.#context.memory.bytesOf(this.#context.shared.resources.testedDepth);
  }

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
        Object.assign(shared.resources, { viewport: this.#viewport, fade: this.#fade });
      },
    };
  }

  write({ request }: FramePlan): void {
    const { fade = 1 } = request;
    if (this.#fade) this.#context.device.queue.writeBuffer(this.#fade, 0, Float32Array.of(fade));
  }

  aim({ shape, destination }: Drawing): void {
    const { resources } = this.#context.shared;
    if (destination.kind !== 'host' || !shape.depth?.isTested) this.#freeTestedDepth();
    if (destination.kind !== 'host') return;
    const { pass } = destination;
    this.fitImage(shape, pass);
    resources.hostDepths = null;
    if (shape.depth?.isTested) {
      this.#fitTestedDepth(resources.layer!);
      resources.hostDepths = this.#views.depth.of(pass.depth!, pass);
    }
    const isReadable = isBindable(pass.color);
    resources.behind = isReadable ? this.#views.behind.of(pass.color, pass) : this.#behindCopy;
    this.#writeViewport(pass, isReadable, this.image!.color);
  }

  /** Makes the textures for drawing over `host`. Call before recording. @throws GpuLimitError */
  fitImage(shape: FrameShape, { color }: HostPass): void {
    const { width, height } = this.#fitComposed(shape).color;
    if (isBindable(color) || this.#behindCopy?.format === color.format) return;
    this.#free(this.#behindCopy);
    this.#behindCopy = null;
    this.#behindCopy = this.#context.memory.createTexture({
      label: 'behind the splats',
      size: { width, height },
      format: color.format,
      usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
    });
  }

  #fitComposed({ depth }: FrameShape): EmbeddedImage {
    const { memory, shared } = this.#context;
    const { width, height } = shared.resources.image!;
    const old = this.image;
    const isSame =
      old?.color.width === width &&
      old.color.height === height &&
      (old.depth !== null) === (depth?.layerFormat != null);
    if (isSame) return old;
    this.#free(old?.color, old?.depth, this.#behindCopy);
    // No texture that is destroyed may be left where the budget does not allow others.
    this.image = null;
    this.#behindCopy = null;
    const { STORAGE_BINDING, TEXTURE_BINDING, COPY_SRC } = GPUTextureUsage;
    const create = (label: string, format: GPUTextureFormat) => {
      const usage = STORAGE_BINDING | TEXTURE_BINDING | COPY_SRC;
      return memory.createTexture({ label, size: { width, height }, format, usage });
    };
    const color = create('splats over the host', COMPOSED_COLOR_FORMAT);
    this.image = { color, depth: null };
    if (depth?.layerFormat)
      this.image = { color, depth: create('depth of the splats', COMPOSED_DEPTH_FORMAT) };
    Object.assign(shared.resources, { composed: color, composedDepth: this.image.depth });
    return this.image;
  }

  #fitTestedDepth({ width, height }: GPUTexture): void {
    const { memory, shared } = this.#context;
    const { testedDepth } = shared.resources;
    if (testedDepth?.width === width && testedDepth.height === height) return;
    this.#freeTestedDepth();
    shared.resources.testedDepth = memory.createTarget('depth of the host', TESTED_DEPTH_FORMAT, {
      width,
      height,
    });
  }

  #freeTestedDepth(): void {
    const { resources } = this.#context.shared;
    this.#free(resources.testedDepth);
    resources.testedDepth = null;
  }

  /** The write comes before the encoder is submitted, so `resolve-depth` sees it too. */
  #writeViewport({ xPx, yPx, writesColor = false }: HostPass, isReadable: boolean, image: GPUTexture): void {
    const { device, shared } = this.#context;
    const { layer } = shared.resources;
    const pxPerLayerPx = [image.width / layer!.width, image.height / layer!.height];
    const key = `${xPx} ${yPx} ${isReadable} ${pxPerLayerPx} ${writesColor}`;
    if (key === this.#viewportKey) return;
    this.#viewportKey = key;
    const contents = HostViewport.pack({
      colorOriginPx: isReadable ? [xPx, yPx] : [0, 0],
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

/** The view of a host texture's layer: most hosts hand over the same texture in every frame. */
class LayerView {
  readonly #aspect: GPUTextureAspect;
  #texture: GPUTexture | null = null;
  #layer = 0;
  #view: GPUTextureView | null = null;

  constructor(aspect: GPUTextureAspect = 'all') {
    this.#aspect = aspect;
  }

  of(texture: GPUTexture, { layer = 0 }: HostPass): GPUTextureView {
    if (this.#view && texture === this.#texture && layer === this.#layer) return this.#view;
    this.#texture = texture;
    this.#layer = layer;
    const baseArrayLayer = texture.depthOrArrayLayers > 1 ? layer : 0;
    const place = { dimension: '2d', baseArrayLayer, arrayLayerCount: 1 } as const;
    this.#view = texture.createView({ aspect: this.#aspect, ...place });
    return this.#view;
  }
}

function isBindable({ usage }: GPUTexture): boolean {
  return (usage & GPUTextureUsage.TEXTURE_BINDING) !== 0;
}

/** Whether the host's depth has several samples. */
export function isMultisampled(destination: Destination): boolean {
  return destination.kind === 'host' && (destination.pass.depth?.sampleCount ?? 1) > 1;
}

/** Copies of colours from the host, if stages cannot read them there, and to the host if it shows them. */
export function hostCopies({
  destination,
  resources: { behind, composed },
}: {
  readonly destination: Destination;
  readonly resources: FrameResources;
}): Pick<ComputePass, 'copyBefore' | 'copyAfter'> {
  if (destination.kind !== 'host') return {};
  const { pass } = destination;
  return {
    ...(!isBindable(pass.color) && { copyBefore: between(pass, behind as GPUTexture, 'from the host') }),
    ...(pass.writesColor && { copyAfter: between(pass, composed!, 'to the host') }),
  };
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
