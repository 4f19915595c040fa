import type { DepthConvention } from '../camera/depth-convention.ts';
import { DestroyedError, InvalidArgumentError } from '../errors.ts';
import { frameStages } from '../frame/frame.ts';
import { checkFrame, keysOf, type ViewFrame } from '../frame/frame-request.ts';
import { type FrameShape, isScaled } from '../frame/frame-shape.ts';
import type { CompiledStage } from '../gpu/pipelines.ts';
import { HostViewport } from '../layout/structs.ts';
import type { EffectEntry } from '../ledger/ledger.ts';
import type { AccuracyChoice } from '../measure/choose-accuracy.ts';
import { COMPOSED_COLOR_FORMAT, COMPOSED_DEPTH_FORMAT, compose, composeState } from '../stages/compose.ts';
import { type RasterizeDepth, TESTED_DEPTH_FORMAT } from '../stages/rasterize.ts';
import { resolveDepth, resolveDepthState } from '../stages/resolve-depth.ts';
import type { FrameStatistics } from '../timing/frame-statistics.ts';
import type { ChooseAccuracyOptions } from './accuracy-wishes.ts';
import { BlendedLayer, type FramePlan, type ViewContext } from './blended-layer.ts';
import type { SplatPick } from './pick-splat.ts';
import { ViewAccuracy } from './view-accuracy.ts';

/** What splats are to show in another renderer's picture. */
export interface EmbeddedFrame
  extends Pick<ViewFrame, 'camera' | 'clouds' | 'widthPx' | 'heightPx' | 'accuracy'> {
  /** How the host stores depth; absent: nothing hides splats. */
  readonly depth?: DepthConvention;
  /**
   * Whether there may be something in the host's depth; default true. Where not, splats are drawn without looking there. It
   * may change from frame to frame.
   */
  readonly hasOccluders?: boolean;
  /** Whether the picture is to have the splats' depth too; only with `depth`. */
  readonly writesDepth?: boolean;
}

/** What lies behind the splats, between two passes of the host. */
export interface HostPass {
  /** Linear light, premultiplied, one sample; with TEXTURE_BINDING or else COPY_SRC. */
  readonly color: GPUTexture;
  /** Of one or several samples, with TEXTURE_BINDING; null where the host has none. */
  readonly depth: GPUTexture | null;
  /** Top left of the viewport within both, in pixels. */
  readonly xPx: number;
  readonly yPx: number;
  /** Layer of textures that have several, e.g. a cube's face; default 0. */
  readonly layer?: number;
}

/** Splats over what was behind them, of the viewport's size. Valid until the view draws again. */
export interface EmbeddedPicture {
  /** rgba16float: linear light, premultiplied, what was behind included; opacity 0 exactly where there is no splat. */
  readonly color: GPUTexture;
  /** r32float: mean depth of the splats as the host stores it, −1 where they cover less than half; null unless asked for. */
  readonly depth: GPUTexture | null;
}

/** How long a picture's textures are used. */
interface PictureTextures extends EmbeddedPicture {
  readonly testedDepth: GPUTexture | null;
}

/**
 * Splats inside another renderer's frame: hidden by what it has drawn, blended over it in the space that splats are
 * trained in. The host ends its pass, lets this view record into its encoder, shows the picture in its next pass, opaque
 * where there are splats, and goes on.
 */
export class EmbeddedView {
  /** Called when shaders that a frame lacked have been compiled, or its accuracy has been chosen: prepare it again. */
  onReady: (() => void) | null = null;
  /** Called some frames after each picture that was measured. */
  onStatistics: ((statistics: FrameStatistics) => void) | null = null;
  /** See `SplatView.onAccuracyChosen`; the picture follows with the frame that `onReady` asks for. */
  onAccuracyChosen: ((choice: AccuracyChoice) => void) | null = null;
  readonly #context: ViewContext;
  readonly #layer: BlendedLayer;
  readonly #accuracy: ViewAccuracy;
  readonly #onDestroyed: (view: EmbeddedView) => void;
  readonly #viewport: GPUBuffer;
  #textures: PictureTextures | null = null;
  #behindCopy: GPUTexture | null = null;
  #viewportKey = '';
  #isCompiling = false;
  #statistics: FrameStatistics | null = null;
  #isDestroyed = false;

  /**
   * @internal Use `engine.createEmbeddedView`.
   * @param onDestroyed called when the view has been destroyed.
   */
  constructor(context: ViewContext, onDestroyed: (view: EmbeddedView) => void) {
    this.#context = context;
    this.#onDestroyed = onDestroyed;
    this.#layer = new BlendedLayer(context);
    this.#accuracy = new ViewAccuracy(context, (choice) => {
      this.onReady?.();
      this.onAccuracyChosen?.(choice);
    });
    const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
    this.#viewport = context.memory.createBuffer('host viewport', HostViewport.bytes, usage);
  }

  /** The newest measurement, or null before the first. */
  get statistics(): FrameStatistics | null {
    return this.#statistics;
  }

  /** What is drawn because of a wish; null before the first choice, and where settings are asked for. */
  get accuracyChoice(): AccuracyChoice | null {
    return this.#accuracy.choice;
  }

  /**
   * Finds and sorts the visible splats: submits that work at once, or none where camera, clouds, size and accuracy are
   * those of the last frame.
   *
   * @returns whether there is something to draw. False where there are no clouds or pixels, where shaders are still being
   *   compiled (`onReady` tells when they are), and after the loss of the device.
   * @throws InvalidArgumentError, GpuLimitError, DestroyedError.
   */
  prepare(frame: EmbeddedFrame): boolean {
    if (this.#isDestroyed) throw new DestroyedError('This view', 'it was destroyed');
    checkFrame(frame, this.#context.device);
    const isEmpty = frame.widthPx === 0 || frame.heightPx === 0 || frame.clouds.length === 0;
    if (isEmpty || this.#context.destroyedBecause() !== null) return false;
    const depths = this.#depthsFor(frame);
    const [depth] = depths;
    const accuracy = this.#accuracy.settingsFor(frame);
    const layer = this.#layer;
    layer.timer.begin();
    const keys = keysOf(frame, accuracy);
    if (!layer.isPrepared(keys, depth)) {
      const plan = layer.planFor(frame, keys, accuracy, depth);
      const drawable = this.#isCompiled(plan.shape) ? plan : layer.stopgapFor(plan, depths);
      if (!drawable) return false;
      if (drawable === plan || !layer.isPrepared(drawable.keys, drawable.shape.depth))
        this.#compute(drawable);
      if (drawable === plan && frame.depth && !depth) this.#expectOccluders(plan.shape, depths[1]!);
    }
    this.#accuracy.show(frame);
    return true;
  }

  /**
   * Records drawing the frame that was prepared last, between two passes of the host, which submits it.
   *
   * @throws InvalidArgumentError where nothing was prepared, or depth was promised and is missing.
   */
  draw(encoder: GPUCommandEncoder, pass: HostPass): EmbeddedPicture {
    const layer = this.#layer;
    const shape = layer.frame?.shape;
    if (!shape) {
      throw new InvalidArgumentError(
        'draw',
        'There is nothing to draw yet: prepare has to return true first.',
      );
    }
    const textures = this.#texturesFor(shape);
    if (textures.testedDepth && !pass.depth) {
      throw new InvalidArgumentError(
        'depth',
        'The frame was prepared to be hidden by depth and the host gave none.',
      );
    }
    const behind = this.#readable(encoder, pass, textures.color);
    this.#writeViewport(pass, behind, textures);
    if (textures.testedDepth) this.#recordResolve(encoder, pass, shape, textures.testedDepth);
    layer.recordRasterize(encoder, textures.testedDepth);
    this.#recordCompose(encoder, pass, behind, textures, shape);
    layer.recordTimes(encoder);
    // The host submits before it gives up control; reading back may not begin earlier.
    queueMicrotask(() => void this.#measure());
    return textures;
  }

  /**
   * The splat that contributes most to a pixel of the frame that was prepared last, whatever the host draws in front of it;
   * null where there is none, outside of the picture, and before the first frame.
   *
   * @param xPx, yPx from the viewport's top left.
   * @throws DestroyedError where the view or its engine end meanwhile.
   */
  async pick(xPx: number, yPx: number): Promise<SplatPick | null> {
    if (this.#isDestroyed) throw new DestroyedError('This view', 'it was destroyed');
    return this.#layer.pick(xPx, yPx);
  }

  /** See `SplatView.chooseAccuracy`. */
  async chooseAccuracy(options: ChooseAccuracyOptions = {}): Promise<AccuracyChoice> {
    if (this.#isDestroyed) throw new DestroyedError('This view', 'it was destroyed');
    return this.#accuracy.choose(options);
  }

  /** See `SplatView.effects`. */
  effects(): readonly EffectEntry[] {
    return this.#layer.effects(this.#textures);
  }

  /** @internal Number of the last picture among all that the engine has drawn; 0 before the first. */
  get drawnAs(): number {
    return this.#layer.drawnAs;
  }

  /** @internal Of the last picture; null before the first. */
  get shape(): FrameShape | null {
    return this.#layer.frame?.shape ?? null;
  }

  /** Frees what the view holds on the GPU, once the host has submitted what it is recording; the clouds stay. */
  destroy(): void {
    if (this.#isDestroyed) return;
    this.#isDestroyed = true;
    this.#accuracy.leave();
    this.#onDestroyed(this);
    queueMicrotask(() => {
      this.#layer.destroy();
      this.#context.memory.destroy(this.#viewport);
      const { color, depth, testedDepth } = this.#textures ?? {};
      this.#free(color, depth, testedDepth, this.#behindCopy);
    });
  }

  #compute(plan: FramePlan): void {
    this.#layer.update(plan);
    const { device } = this.#context;
    const encoder = device.createCommandEncoder({ label: 'websplatter pre-process and sort' });
    this.#layer.recordCompute(encoder);
    device.queue.submit([encoder.finish()]);
  }

  /** What a frame asks of depth, and after that what else it may be drawn with as long as shaders for that are lacking. */
  #depthsFor(frame: EmbeddedFrame): readonly [RasterizeDepth | null, ...(RasterizeDepth | null)[]] {
    const { camera, depth, hasOccluders = true, writesDepth = false } = frame;
    if (!depth) return [null];
    const { mapping, compare } = depth;
    const isOrthographic = camera.projectionMatrix[11] === 0;
    const isBlendable = this.#context.device.features.has('float32-blendable' as GPUFeatureName);
    const tested: RasterizeDepth = { mapping, compare, isOrthographic, layerFormat: null };
    const written: RasterizeDepth = { ...tested, layerFormat: isBlendable ? 'r32float' : 'r16float' };
    if (writesDepth) return [written, tested, null];
    return hasOccluders ? [tested, written, null] : [null, tested, written];
  }

  /** Something may come to hide the splats of this shape: it is to be hidden behind from its first frame on. */
  #expectOccluders(shape: FrameShape, depth: RasterizeDepth): void {
    const { pipelines } = this.#context;
    const stages = embeddedStages({ ...shape, depth });
    if (!pipelines.areReady(stages)) pipelines.prepare(stages).catch(() => {});
  }

  #isCompiled(shape: FrameShape): boolean {
    const { pipelines } = this.#context;
    const stages = embeddedStages(shape);
    if (pipelines.areReady(stages)) return true;
    if (!this.#isCompiling) {
      this.#isCompiling = true;
      pipelines.prepare(stages).then(
        () => {
          this.#isCompiling = false;
          if (!this.#isDestroyed) this.onReady?.();
        },
        // The device reports a shader that does not compile; another frame may try again.
        () => {
          this.#isCompiling = false;
        },
      );
    }
    return false;
  }

  #texturesFor({ depth }: FrameShape): PictureTextures {
    const { width, height } = this.#layer.color!;
    const blended = this.#layer.blendedSize!;
    const old = this.#textures;
    const isSame =
      old?.color.width === width &&
      old.color.height === height &&
      (old.depth !== null) === (depth?.layerFormat != null) &&
      (old.testedDepth !== null) === (depth !== null) &&
      (depth === null ||
        (old.testedDepth?.width === blended.width && old.testedDepth.height === blended.height));
    if (isSame) return old;
    this.#free(old?.color, old?.depth, old?.testedDepth, this.#behindCopy);
    this.#behindCopy = null;
    const { memory } = this.#context;
    const size = { width, height };
    this.#textures = {
      color: memory.createTarget('splats over the host', COMPOSED_COLOR_FORMAT, size),
      depth: depth?.layerFormat
        ? memory.createTarget('depth of the splats', COMPOSED_DEPTH_FORMAT, size)
        : null,
      testedDepth: depth && memory.createTarget('depth of the host', TESTED_DEPTH_FORMAT, blended),
    };
    return this.#textures;
  }

  #writeViewport({ color, xPx, yPx }: HostPass, behind: GPUTexture, textures: PictureTextures): void {
    const { width, height } = textures.color;
    const blended = this.#layer.blendedSize!;
    const pxPerLayerPx = [width / blended.width, height / blended.height];
    const key = `${xPx} ${yPx} ${behind === color} ${pxPerLayerPx}`;
    if (key === this.#viewportKey) return;
    this.#viewportKey = key;
    const contents = new ArrayBuffer(HostViewport.bytes);
    HostViewport.write(contents, {
      colorOriginPx: behind === color ? [xPx, yPx] : [0, 0],
      depthOriginPx: [xPx, yPx],
      pxPerLayerPx,
    });
    this.#context.device.queue.writeBuffer(this.#viewport, 0, contents);
  }

  #recordResolve(encoder: GPUCommandEncoder, host: HostPass, shape: FrameShape, target: GPUTexture): void {
    const { pipelines } = this.#context;
    const stage = resolveDepth(shape.depth!.compare, isMultisampled(host), isScaled(shape));
    const pass = encoder.beginRenderPass({
      label: 'resolve depth',
      colorAttachments: [],
      depthStencilAttachment: {
        view: target.createView(),
        depthLoadOp: 'clear',
        depthStoreOp: 'store',
        depthClearValue: 0,
      },
      timestampWrites: this.#layer.timer.writes('resolve-depth'),
    });
    pass.setPipeline(pipelines.render(stage, resolveDepthState)!);
    const bindings = {
      viewport: this.#viewport,
      hostDepths: depthView(host),
    };
    pass.setBindGroup(0, pipelines.bindGroup(stage, bindings));
    pass.draw(3);
    pass.end();
  }

  #recordCompose(
    encoder: GPUCommandEncoder,
    host: HostPass,
    behind: GPUTexture,
    { color, depth }: EmbeddedPicture,
    shape: FrameShape,
  ): void {
    const { pipelines } = this.#context;
    const layer = this.#layer;
    const isEdged = shape.depth !== null && isMultisampled(host);
    const stage = compose(shape.depth, isEdged);
    const pass = encoder.beginRenderPass({
      label: 'compose',
      colorAttachments: [color, depth]
        .filter((texture) => texture !== null)
        .map((texture) => ({ view: texture.createView(), loadOp: 'clear', storeOp: 'store' })),
      timestampWrites: layer.timer.writes('composite'),
    });
    pass.setPipeline(pipelines.render(stage, composeState(shape.depth))!);
    const bindings = {
      viewport: this.#viewport,
      layer: layer.color!.createView(),
      behind: behind === host.color ? layerView(behind, host) : behind.createView(),
      ...(layer.depth && { depthLayer: layer.depth.createView() }),
      ...(layer.frame!.hostDepth && { hostDepth: layer.frame!.hostDepth }),
      ...(isEdged && { hostDepths: depthView(host) }),
    };
    pass.setBindGroup(0, pipelines.bindGroup(stage, bindings));
    pass.draw(3);
    pass.end();
  }

  /** The host's colour where it can be bound, else a copy of what the viewport shows of it. */
  #readable(encoder: GPUCommandEncoder, host: HostPass, { width, height }: GPUTexture): GPUTexture {
    const { color, xPx, yPx, layer = 0 } = host;
    if (color.usage & GPUTextureUsage.TEXTURE_BINDING) return color;
    if (this.#behindCopy?.format !== color.format) {
      this.#free(this.#behindCopy);
      this.#behindCopy = this.#context.memory.createTexture({
        label: 'behind the splats',
        size: { width, height },
        format: color.format,
        usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
      });
    }
    const copy = this.#behindCopy;
    // A viewport may reach beyond its target.
    const [left, top] = [Math.max(0, xPx), Math.max(0, yPx)];
    const [right, bottom] = [Math.min(color.width, xPx + width), Math.min(color.height, yPx + height)];
    if (right > left && bottom > top) {
      const from = { texture: color, origin: [left, top, layer] };
      const to = { texture: copy, origin: [left - xPx, top - yPx] };
      encoder.copyTextureToTexture(from, to, [right - left, bottom - top]);
    }
    return copy;
  }

  #free(...textures: (GPUTexture | null | undefined)[]): void {
    for (const texture of textures) if (texture) this.#context.memory.destroy(texture);
  }

  async #measure(): Promise<void> {
    const statistics = await this.#layer.measure();
    if (!statistics || this.#isDestroyed) return;
    this.#statistics = statistics;
    this.onStatistics?.(statistics);
  }
}

/** The layer of one of the host's textures that its pass is about. */
function layerView(
  texture: GPUTexture,
  { layer = 0 }: HostPass,
  options: GPUTextureViewDescriptor = {},
): GPUTextureView {
  const baseArrayLayer = texture.depthOrArrayLayers > 1 ? layer : 0;
  return texture.createView({ ...options, dimension: '2d', baseArrayLayer, arrayLayerCount: 1 });
}

/** All that a frame inside of another renderer's runs. */
function embeddedStages(shape: FrameShape): CompiledStage[] {
  const { depth } = shape;
  const stages = frameStages(shape);
  // Whether the host's depth has several samples is known when it is drawn.
  for (const many of depth ? [false, true] : [false]) {
    stages.push([compose(depth, many), composeState(depth)]);
    if (depth) stages.push([resolveDepth(depth.compare, many, isScaled(shape)), resolveDepthState]);
  }
  return stages;
}

function isMultisampled({ depth }: HostPass): boolean {
  return depth !== null && depth.sampleCount > 1;
}

function depthView(host: HostPass): GPUTextureView {
  return layerView(host.depth!, host, { aspect: 'depth-only' });
}
