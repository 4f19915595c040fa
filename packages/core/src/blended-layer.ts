import type { Accuracy, AccuracySettings } from './accuracy.ts';
import { projectionOf } from './camera.ts';
import { InvalidArgumentError } from './errors.ts';
import { recordCompute, recordRasterize } from './frame.ts';
import { FrameResources } from './frame-resources.ts';
import { type FrameShape, isSameShape } from './frame-shape.ts';
import { hostDepthUniform, pageUniforms, viewUniforms } from './frame-uniforms.ts';
import type { Counting } from './gpu/engine-counters.ts';
import type { GpuMemory } from './gpu/gpu-memory.ts';
import type { Pipelines } from './gpu/pipelines.ts';
import { pickSplat, type SplatPick } from './pick.ts';
import type { ViewFrame } from './scene/view-frame.ts';
import { pick } from './stages/pick.ts';
import type { FrameStatistics } from './timing/frame-statistics.ts';
import { GpuTimer } from './timing/gpu-timer.ts';

/** What a view needs of its engine. */
export interface ViewContext {
  readonly device: GPUDevice;
  readonly pipelines: Pipelines;
  readonly memory: GpuMemory;
  readonly counting: Counting;
  /** The settings of a frame that asks for these, or for none: one object for equal settings. */
  readonly accuracyFor: (asked: Accuracy | undefined) => AccuracySettings;
  readonly dispatchRow: number;
  /** Why nothing can be drawn any more, or null. */
  readonly destroyedBecause: () => string | null;
}

/**
 * The splats of one view: their buffers, and the texture in which they are blended over nothing. Views decide when it is
 * drawn and what becomes of it.
 */
export class BlendedLayer {
  readonly timer: GpuTimer;
  readonly #context: ViewContext;
  #frame: FrameResources | null = null;
  #color: GPUTexture | null = null;
  #depth: GPUTexture | null = null;
  #frameNumber = 0;
  #picture: Pick<ViewFrame, 'camera' | 'widthPx' | 'heightPx'> | null = null;
  #isDestroyed = false;

  constructor(context: ViewContext) {
    this.#context = context;
    this.timer = new GpuTimer(context.device, context.memory);
  }

  get frame(): FrameResources | null {
    return this.#frame;
  }

  /** Premultiplied RGBA in the space that splats are blended in; null before the first picture. */
  get color(): GPUTexture | null {
    return this.#color;
  }

  /** View depth weighted like the colours, where the frame's shape asks for it. */
  get depth(): GPUTexture | null {
    return this.#depth;
  }

  /**
   * Makes room for a frame of this shape and writes its uniforms.
   *
   * @returns whether the textures are others than before.
   * @throws InvalidArgumentError, GpuLimitError; the old picture stays then.
   */
  update(viewFrame: ViewFrame, shape: FrameShape): boolean {
    const { device, pipelines, memory } = this.#context;
    const { camera, widthPx, heightPx } = viewFrame;
    checkSize(device, widthPx, heightPx);
    if (!this.#frame || !isSameShape(this.#frame.shape, shape)) {
      // The new one first: where it does not fit, the old picture stays.
      const next = new FrameResources(device, pipelines, memory, shape);
      this.#frame?.destroy();
      this.#frame = next;
    }
    const frame = this.#frame;
    const projection = projectionOf(camera, widthPx, heightPx);
    frame.writeUniforms(viewUniforms(projection, shape), pageUniforms(viewFrame, projection, frame));
    if (shape.depth) frame.writeHostDepth(hostDepthUniform(camera, shape.depth.mapping));
    this.#picture = { camera, widthPx, heightPx };
    return this.#resize(widthPx, heightPx, shape);
  }

  recordCompute(encoder: GPUCommandEncoder): void {
    recordCompute(encoder, this.#context.pipelines, this.#frame!, this.timer);
    this.#context.counting.framesPrepared++;
  }

  /** @param testedDepth what the host has drawn, where the frame's shape has depth. */
  recordRasterize(encoder: GPUCommandEncoder, testedDepth: GPUTexture | null): void {
    const targets = { color: this.#color!, depthLayer: this.#depth, testedDepth };
    recordRasterize(encoder, this.#context.pipelines, this.#frame!, targets, this.timer);
    this.#context.counting.framesDrawn++;
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
    while (this.#frame && this.#picture && !this.#isDestroyed) {
      const { widthPx, heightPx } = this.#picture;
      if (!(xPx >= 0 && xPx < widthPx && yPx >= 0 && yPx < heightPx)) return null;
      const stage = pick(this.#frame.shape.accuracy.recordPrecision);
      if (pipelines.areReady([stage])) return pickSplat(this.#context, this.#frame, this.#picture, xPx, yPx);
      // While this compiles another frame may be drawn, with other records, or the last one.
      await pipelines.prepare([stage]);
    }
    return null;
  }

  destroy(): void {
    this.#isDestroyed = true;
    const { memory } = this.#context;
    this.#frame?.destroy();
    for (const texture of [this.#color, this.#depth]) if (texture) memory.destroy(texture);
    this.timer.destroy();
  }

  #resize(widthPx: number, heightPx: number, { accuracy, depth }: FrameShape): boolean {
    const depthFormat = depth?.layerFormat ?? null;
    const isSameSize = this.#color?.width === widthPx && this.#color.height === heightPx;
    const isSameFormat =
      this.#color?.format === accuracy.colorTarget && (this.#depth?.format ?? null) === depthFormat;
    if (isSameSize && isSameFormat) return false;
    const { memory } = this.#context;
    for (const texture of [this.#color, this.#depth]) if (texture) memory.destroy(texture);
    const texture = (label: string, format: GPUTextureFormat) =>
      memory.createTexture({
        label,
        size: { width: widthPx, height: heightPx },
        format,
        usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_SRC,
      });
    this.#color = texture('splat layer', accuracy.colorTarget);
    this.#depth = depthFormat && texture('splat depth layer', depthFormat);
    return true;
  }
}

function checkSize({ limits }: GPUDevice, widthPx: number, heightPx: number): void {
  const limit = limits.maxTextureDimension2D;
  if (Math.max(widthPx, heightPx) <= limit) return;
  const message = `A picture of ${widthPx}×${heightPx} px is larger than this device's ${limit} px (maxTextureDimension2D).`;
  throw new InvalidArgumentError('widthPx', message);
}
