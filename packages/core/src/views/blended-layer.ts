import { type AccuracySettings, layerSize } from '../accuracy/accuracy.ts';
import { projectionOf } from '../camera/camera.ts';
import { effectSetOf } from '../effects/effect-set.ts';
import { usesOf } from '../effects/effects.ts';
import { InvalidArgumentError } from '../errors.ts';
import { ColorCache, canKeep } from '../frame/color-cache.ts';
import {
  frameStages,
  keepingStages,
  recordCompute,
  recordKeepColors,
  recordRasterize,
  recordUpscale,
} from '../frame/frame.ts';
import { type FrameKeys, keysOf, type ViewFrame } from '../frame/frame-request.ts';
import { effectsStride, type FramePage, FrameResources } from '../frame/frame-resources.ts';
import {
  type FrameShape,
  hasSameBuffers,
  isSameShape,
  isScaled,
  type OmittableEffect,
  shapeOf,
} from '../frame/frame-shape.ts';
import { effectUniforms, hostDepthUniform, pageUniforms, viewUniforms } from '../frame/frame-uniforms.ts';
import type { Counting } from '../gpu/engine-counters.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { Pipelines } from '../gpu/pipelines.ts';
import { UpscaleParameters } from '../layout/structs.ts';
import { type EffectEntry, effectsLedger } from '../ledger/ledger.ts';
import { pick } from '../stages/pick.ts';
import type { RasterizeDepth } from '../stages/rasterize.ts';
import type { FrameStatistics } from '../timing/frame-statistics.ts';
import { GpuTimer } from '../timing/gpu-timer.ts';
import { pickSplat, type SplatPick } from './pick-splat.ts';
import type { AccuracyContext } from './view-accuracy.ts';

/** What a view needs of its engine. */
export interface ViewContext extends AccuracyContext {
  readonly device: GPUDevice;
  readonly pipelines: Pipelines;
  readonly memory: GpuMemory;
  readonly counting: Counting;
  readonly dispatchRow: number;
  /** Why nothing can be drawn any more, or null. */
  readonly destroyedBecause: () => string | null;
}

/** A frame as it is to be drawn. */
export interface FramePlan {
  readonly frame: ViewFrame;
  readonly keys: FrameKeys;
  readonly shape: FrameShape;
}

/**
 * The splats of one view: their buffers, and the texture in which they are blended over nothing. Views decide when it is
 * drawn and what becomes of it.
 */
export class BlendedLayer {
  readonly timer: GpuTimer;
  /** What pictures are drawn without, for measurements. Nothing is drawn anew because of it alone. */
  omittedEffects: readonly OmittableEffect[] = [];
  readonly #context: ViewContext;
  readonly #colors: ColorCache;
  #frame: FrameResources | null = null;
  /** What views read, of the picture's size. */
  #textures: LayerTextures | null = null;
  /** What splats are blended in: the same, or smaller ones. */
  #blended: LayerTextures | null = null;
  #upscaleParameters: GPUBuffer | null = null;
  #frameNumber = 0;
  #drawnAs = 0;
  #prepared: FramePlan | null = null;
  /** Whether all but the colours of the splats is as it was in the picture before. */
  #isColorsOnly = false;
  #isDestroyed = false;

  constructor(context: ViewContext) {
    this.#context = context;
    this.timer = new GpuTimer(context.device, context.memory);
    this.#colors = new ColorCache(context.memory, context.device.queue);
  }

  get frame(): FrameResources | null {
    return this.#frame;
  }

  /** Premultiplied RGBA in the space that splats are blended in; null before the first picture. */
  get color(): GPUTexture | null {
    return this.#textures?.color ?? null;
  }

  /** View depth weighted like the colours, where the frame's shape asks for it. */
  get depth(): GPUTexture | null {
    return this.#textures?.depthLayer ?? null;
  }

  /** Size of the texture that splats are blended in, px; null before the first picture. */
  get blendedSize(): Pick<GPUTexture, 'width' | 'height'> | null {
    return this.#blended?.color ?? null;
  }

  /** Number of the last picture among those that the engine has drawn; 0 before the first. */
  get drawnAs(): number {
    return this.#drawnAs;
  }

  /**
   * See `SplatView.effects`.
   *
   * @param host textures that a view inside another renderer's frame holds for that.
   */
  effects(host: HostTextures | null = null): readonly EffectEntry[] {
    const resources = this.#frame;
    if (!resources || !this.#prepared) return [];
    const { frame, shape } = this.#prepared;
    const { memory } = this.#context;
    const bytesOf = (each: readonly (GPUBuffer | GPUTexture | null | undefined)[]) =>
      [...new Set(each)].reduce((sum, resource) => sum + memory.bytesOf(resource), 0);
    const held = {
      selectionBytes: (cloudIndex: number) => resources.selectionBytes(cloudIndex),
      keptColorsBytes: this.#colors.bytes,
      testedDepthBytes: bytesOf([resources.hostDepth, host?.testedDepth]),
      writtenDepthBytes: bytesOf([this.#textures?.depthLayer, this.#blended?.depthLayer, host?.depth]),
    };
    return effectsLedger({ frame, shape, held });
  }

  /** What a frame asks for; see `stopgapFor` where its shaders are not compiled yet. */
  planFor(
    frame: ViewFrame,
    keys: FrameKeys,
    accuracy: AccuracySettings,
    depth: RasterizeDepth | null = null,
  ): FramePlan {
    const { dispatchRow } = this.#context;
    const request = { accuracy, dispatchRow, depth };
    const shape = shapeOf(frame, request, this.omittedEffects, this.#frame?.shape);
    return { frame, keys, shape: this.#keepingColors(frame, shape) };
  }

  /**
   * The same frame with the settings and effects of the last picture in place of those whose shaders are still compiling, so
   * that nothing stands still for that; null where there is none, or it would be of other clouds.
   *
   * @param depths one of these the last picture's depth has to be.
   */
  stopgapFor(
    { frame, shape }: FramePlan,
    depths: readonly (RasterizeDepth | null)[] = [shape.depth],
  ): FramePlan | null {
    const last = this.#prepared;
    if (!last || last.frame.clouds.length !== frame.clouds.length) return null;
    const { depth } = last.shape;
    if (!depths.some((possible) => JSON.stringify(possible) === JSON.stringify(depth))) return null;
    if (frame.clouds.some(({ cloud }, i) => cloud !== last.frame.clouds[i].cloud)) return null;
    const clouds = frame.clouds.map((instance, i) => {
      const { opacity, effects, shDegree } = last.frame.clouds[i];
      const drawn = last.shape.effects[i];
      if (effectSetOf(usesOf(instance)) === drawn) return { ...instance, shDegree };
      // One may have been called for only since then, by what was selected.
      const before = effects?.filter(
        ({ effect, reason }) => reason === null || drawn.effects.includes(effect),
      );
      return { ...instance, shDegree, opacity, effects: before };
    });
    const { accuracy } = last.shape;
    const asBefore = { ...frame, clouds };
    const stopgap = this.planFor(asBefore, keysOf(asBefore, accuracy), accuracy, depth);
    return this.#context.pipelines.areReady(frameStages(stopgap.shape)) ? stopgap : null;
  }

  /** Whether the splats of the last picture are those of a frame with these keys. */
  isPrepared(keys: FrameKeys, depth: RasterizeDepth | null = null): boolean {
    const last = this.#prepared;
    return (
      last?.keys.order === keys.order &&
      last.keys.colors === keys.colors &&
      JSON.stringify(last.shape.depth) === JSON.stringify(depth)
    );
  }

  /**
   * Makes room for a frame and writes its uniforms.
   *
   * @returns whether the textures are others than before.
   * @throws InvalidArgumentError, GpuLimitError; the old picture stays then.
   */
  update(plan: FramePlan): boolean {
    const { device, pipelines, memory } = this.#context;
    const { frame: viewFrame, shape, keys } = plan;
    const { camera, widthPx, heightPx } = viewFrame;
    this.#isColorsOnly = !viewFrame.force && this.#prepared?.keys.order === keys.order;
    checkSize(device, widthPx, heightPx);
    const last = this.#frame;
    // What may throw comes first, parameters of callers' effects and buffers that do not fit: the old picture stays then.
    const effects = effectUniforms(viewFrame, effectsStride(shape));
    const frame =
      last && hasSameBuffers(last.shape, shape)
        ? last
        : new FrameResources(device, pipelines, memory, shape, this.#colors);
    this.#keepColors(plan, frame.pages);
    if (frame !== last) {
      last?.destroy();
      this.#frame = frame;
      this.#isColorsOnly = false;
    } else if (!isSameShape(last.shape, shape)) {
      frame.reshape(shape);
    }
    const layer = layerSize(viewFrame, shape.accuracy);
    const projection = projectionOf(camera, layer.widthPx, layer.heightPx);
    frame.writeUniforms(viewUniforms(projection, shape), pageUniforms(viewFrame, projection, frame));
    frame.writeEffects(effects);
    frame.writeSelections(viewFrame.clouds);
    if (shape.depth) frame.writeHostDepth(hostDepthUniform(camera, shape.depth.mapping));
    // Callers may change their lists later on: what was drawn stays known.
    const clouds = viewFrame.clouds.map((instance) => ({ ...instance }));
    this.#prepared = { ...plan, frame: { ...viewFrame, clouds } };
    return this.#resize(widthPx, heightPx, shape);
  }

  recordCompute(encoder: GPUCommandEncoder): void {
    recordCompute(encoder, this.#context.pipelines, this.#frame!, this.timer, this.#isColorsOnly);
    this.#context.counting.framesPrepared++;
  }

  /** @param testedDepth what the host has drawn, where the frame's shape has depth. */
  recordRasterize(encoder: GPUCommandEncoder, testedDepth: GPUTexture | null): void {
    const { pipelines } = this.#context;
    const frame = this.#frame!;
    recordRasterize(encoder, pipelines, frame, { ...this.#blended!, testedDepth }, this.timer);
    if (this.#upscaleParameters && isScaled(frame.shape)) {
      const targets = { from: this.#blended!, to: this.#textures!, parameters: this.#upscaleParameters };
      recordUpscale(encoder, pipelines, frame, targets, this.timer);
    }
    this.#drawnAs = ++this.#context.counting.framesDrawn;
  }

  /** Call after the last pass, before the encoder is finished. */
  recordTimes(encoder: GPUCommandEncoder): void {
    this.timer.record(encoder, this.#frame!.buffers);
  }

  /** Call after submitting. Answers when the picture is done, or null where it was not measured. */
  measure(): Promise<FrameStatistics | null> {
    return this.timer.read(++this.#frameNumber, this.#frame?.totalSplats ?? 0);
  }

  /** See `SplatView.pick`. */
  async pick(xPx: number, yPx: number): Promise<SplatPick | null> {
    const { pipelines } = this.#context;
    while (this.#frame && this.#prepared && !this.#isDestroyed) {
      const picture = this.#prepared.frame;
      const { widthPx, heightPx } = picture;
      if (!(xPx >= 0 && xPx < widthPx && yPx >= 0 && yPx < heightPx)) return null;
      const stage = pick(this.#frame.shape.accuracy.recordPrecision);
      if (pipelines.areReady([stage])) {
        const layer = layerSize(picture, this.#frame.shape.accuracy);
        // The pixel of the layer behind the middle of the picture's.
        const layerX = ((Math.floor(xPx) + 0.5) * layer.widthPx) / widthPx;
        const layerY = ((Math.floor(yPx) + 0.5) * layer.heightPx) / heightPx;
        return pickSplat(this.#context, this.#frame, { ...picture, ...layer }, layerX, layerY);
      }
      // While this compiles another frame may be drawn, with other records, or the last one.
      await pipelines.prepare([stage]);
    }
    return null;
  }

  destroy(): void {
    this.#isDestroyed = true;
    const { memory } = this.#context;
    this.#frame?.destroy();
    this.#colors.destroy();
    this.#freeTextures();
    if (this.#upscaleParameters) memory.destroy(this.#upscaleParameters);
    this.timer.destroy();
  }

  /** `shape` with colours kept of clouds that are seen again from one place, once the shaders for that are there. */
  #keepingColors(frame: ViewFrame, shape: FrameShape): FrameShape {
    const { pipelines } = this.#context;
    const keeping = (keepsColors: readonly boolean[]) => ({ ...shape, keepsColors });
    const wanted = keeping(this.#colors.wants(frame, shape));
    if (wanted.keepsColors.includes(true)) {
      const isReady = pipelines.areReady(keepingStages(wanted));
      if (isReady || !pipelines.areReady(frameStages(shape))) return wanted;
    }
    // What moves at all may come to turn in place.
    if (this.#prepared && !frame.force) {
      const possible = frame.clouds.map((instance, i) => canKeep(instance, shape, i));
      const stages = keepingStages(keeping(possible));
      if (!pipelines.areReady(stages)) pipelines.prepare(stages).catch(() => {});
    }
    return shape;
  }

  /** Takes colours from the records that stand, before they are written anew or freed. */
  #keepColors({ frame, shape }: FramePlan, nextPages: readonly FramePage[]): void {
    const { device, pipelines } = this.#context;
    const pages = this.#colors.begin(frame, shape, nextPages);
    if (!this.#frame || pages.length === 0) return;
    const encoder = device.createCommandEncoder({ label: 'websplatter keep colors' });
    recordKeepColors(encoder, pipelines, this.#frame, pages);
    device.queue.submit([encoder.finish()]);
  }

  #resize(widthPx: number, heightPx: number, shape: FrameShape): boolean {
    const { accuracy, depth } = shape;
    const depthFormat = depth?.layerFormat ?? null;
    const layer = layerSize({ widthPx, heightPx }, accuracy);
    const isSame =
      hasSize(this.#textures, widthPx, heightPx) &&
      hasSize(this.#blended, layer.widthPx, layer.heightPx) &&
      (this.#blended === this.#textures) === !isScaled(shape) &&
      this.color?.format === accuracy.colorTarget &&
      (this.depth?.format ?? null) === depthFormat;
    if (isSame) return false;
    this.#freeTextures();
    const { memory } = this.#context;
    const textures = (what: string, width: number, height: number): LayerTextures => ({
      color: memory.createTarget(what, accuracy.colorTarget, { width, height }),
      depthLayer: depthFormat && memory.createTarget(`${what} depth`, depthFormat, { width, height }),
    });
    this.#textures = textures('splat layer', widthPx, heightPx);
    this.#blended = this.#textures;
    if (isScaled(shape)) {
      this.#blended = textures('small splat layer', layer.widthPx, layer.heightPx);
      this.#writeUpscale([layer.widthPx / widthPx, layer.heightPx / heightPx]);
    }
    return true;
  }

  #writeUpscale(layerPerPx: readonly [number, number]): void {
    const { device, memory } = this.#context;
    const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
    this.#upscaleParameters ??= memory.createBuffer('upscale parameters', UpscaleParameters.bytes, usage);
    const contents = new ArrayBuffer(UpscaleParameters.bytes);
    UpscaleParameters.write(contents, { layerPerPx });
    device.queue.writeBuffer(this.#upscaleParameters, 0, contents);
  }

  #freeTextures(): void {
    for (const { color, depthLayer } of new Set(
      [this.#textures, this.#blended].filter((each) => each !== null),
    )) {
      this.#context.memory.destroy(color);
      if (depthLayer) this.#context.memory.destroy(depthLayer);
    }
  }
}

/** What a view inside another renderer's frame has of its depth, and gives to it; null where it is not called for. */
interface HostTextures {
  readonly testedDepth: GPUTexture | null;
  readonly depth: GPUTexture | null;
}

interface LayerTextures {
  /** Premultiplied RGBA. */
  readonly color: GPUTexture;
  readonly depthLayer: GPUTexture | null;
}

function hasSize(textures: LayerTextures | null, widthPx: number, heightPx: number): boolean {
  return textures?.color.width === widthPx && textures.color.height === heightPx;
}

function checkSize({ limits }: GPUDevice, widthPx: number, heightPx: number): void {
  const limit = limits.maxTextureDimension2D;
  if (Math.max(widthPx, heightPx) <= limit) return;
  const message = `A picture of ${widthPx}×${heightPx} px is larger than this device's ${limit} px (maxTextureDimension2D).`;
  throw new InvalidArgumentError('widthPx', message);
}
