import type { AccuracySettings } from './accuracy.ts';
import { projectionOf } from './camera.ts';
import { DestroyedError, InvalidArgumentError } from './errors.ts';
import { frameStages, recordFrame } from './frame.ts';
import { FrameResources, type FrameShape } from './frame-resources.ts';
import { pageUniforms, viewUniforms } from './frame-uniforms.ts';
import type { GpuMemory } from './gpu/gpu-memory.ts';
import type { Pipelines, RenderState, StageDefinition } from './gpu/pipelines.ts';
import { readTexture, type TextureImage } from './gpu/read-texture.ts';
import { CompositeParameters } from './layout/structs.ts';
import type { Vec3 } from './math/mat4.ts';
import { keyBitsFor } from './scene/key-bits.ts';
import type { SplatCloud } from './scene/splat-cloud.ts';
import type { ViewFrame } from './scene/view-frame.ts';
import { visibleCapacity } from './scene/visible-capacity.ts';
import { composite, compositeState } from './stages/composite.ts';
import type { FrameStatistics } from './timing/frame-statistics.ts';
import { GpuTimer } from './timing/gpu-timer.ts';

/** What a view needs of its engine. */
export interface ViewContext {
  readonly device: GPUDevice;
  readonly pipelines: Pipelines;
  readonly memory: GpuMemory;
  readonly accuracy: AccuracySettings;
  readonly dispatchRow: number;
  /** Why nothing can be drawn any more, or null. */
  readonly destroyedBecause: () => string | null;
  /** Called when the view has been destroyed. */
  readonly onDestroyed: (view: SplatView) => void;
}

/** One picture of some clouds, drawn again whenever something has changed: on a canvas, or to be read back. */
export class SplatView {
  /** Called some frames after each picture that was measured. */
  onStatistics: ((statistics: FrameStatistics) => void) | null = null;
  readonly #context: ViewContext;
  readonly #canvas: GPUCanvasContext | null;
  readonly #canvasFormat: GPUTextureFormat;
  readonly #timer: GpuTimer;
  readonly #compositeParameters: GPUBuffer;
  #frame: FrameResources | null = null;
  #layer: GPUTexture | null = null;
  #compositeGroup: GPUBindGroup | null = null;
  #drawnKey = '';
  #waiting: ViewFrame | null = null;
  #whenDrawn: Promise<void> = Promise.resolve();
  #statistics: FrameStatistics | null = null;
  #frameNumber = 0;
  #isDestroyed = false;

  /** @internal Use `engine.createView`. */
  constructor(
    context: ViewContext,
    canvas: HTMLCanvasElement | OffscreenCanvas | null,
    canvasFormat: GPUTextureFormat,
  ) {
    this.#context = context;
    this.#canvasFormat = canvasFormat;
    this.#canvas = canvas && configure(canvas, context.device, canvasFormat);
    this.#timer = new GpuTimer(context.device, context.memory);
    this.#compositeParameters = context.memory.createBuffer(
      'composite parameters',
      CompositeParameters.bytes,
      GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST,
    );
  }

  /** The newest measurement, or null before the first. */
  get statistics(): FrameStatistics | null {
    return this.#statistics;
  }

  /**
   * Draws `frame`: submits the GPU's work and returns at once. Where camera, clouds, size and background are those of
   * the last picture nothing is submitted. Where a shader is still being compiled, the picture follows by itself when
   * it is ready; `whenDrawn` waits for that.
   *
   * @returns whether anything was, or will be, submitted.
   * @throws InvalidArgumentError, GpuLimitError, DestroyedError.
   */
  render(frame: ViewFrame): boolean {
    this.#checkUsable();
    checkFrame(frame);
    if (frame.widthPx === 0 || frame.heightPx === 0) return false;
    if (this.#waiting) {
      this.#waiting = frame;
      return true;
    }
    const key = keyOf(frame);
    if (!frame.force && key === this.#drawnKey) return false;
    const shape = shapeOf(frame, this.#context, this.#frame?.shape);
    const stages = this.#stagesFor(shape);
    if (!this.#areCompiled(stages)) {
      this.#waiting = frame;
      this.#whenDrawn = this.#drawWaiting();
      // Who does not wait for the picture still hears of a shader that does not compile, once, by the device's own error.
      this.#whenDrawn.catch(() => {});
      return true;
    }
    this.#draw(frame, shape, key);
    return true;
  }

  /** Resolves when the last picture asked for has been submitted; rejects where its shaders do not compile. */
  whenDrawn(): Promise<void> {
    return this.#whenDrawn;
  }

  /**
   * The last picture, without its background: premultiplied RGBA in the space it was blended in (sRGB-encoded), top row
   * first, 4·width·height values.
   */
  async readPixels(): Promise<TextureImage> {
    await this.#whenDrawn;
    this.#checkUsable();
    if (!this.#layer)
      throw new InvalidArgumentError('readPixels', 'There is no picture yet: call render first.');
    return readTexture(this.#context.device, this.#layer);
  }

  /** Frees what the view holds on the GPU; the clouds stay. */
  destroy(): void {
    if (this.#isDestroyed) return;
    this.#isDestroyed = true;
    this.#waiting = null;
    this.#canvas?.unconfigure();
    this.#frame?.destroy();
    if (this.#layer) this.#context.memory.destroy(this.#layer);
    this.#context.memory.destroy(this.#compositeParameters);
    this.#timer.destroy();
    this.#context.onDestroyed(this);
  }

  /** Compiles what the waiting frame needs, which may be another one by then, and draws it. */
  async #drawWaiting(): Promise<void> {
    try {
      while (this.#waiting && this.#canStillDraw(this.#waiting)) {
        const frame = this.#waiting;
        const shape = shapeOf(frame, this.#context, this.#frame?.shape);
        const stages = this.#stagesFor(shape);
        if (this.#areCompiled(stages)) {
          this.#waiting = null;
          this.#draw(frame, shape, keyOf(frame));
        } else {
          await this.#context.pipelines.prepare(stages);
        }
      }
    } finally {
      this.#waiting = null;
    }
  }

  #canStillDraw({ clouds }: ViewFrame): boolean {
    const isUsable = !this.#isDestroyed && this.#context.destroyedBecause() === null;
    return isUsable && clouds.every(({ cloud }) => !cloud.isDestroyed);
  }

  #draw(viewFrame: ViewFrame, shape: FrameShape, key: string): void {
    const { device, pipelines, memory } = this.#context;
    const { camera, widthPx, heightPx } = viewFrame;
    this.#checkSize(widthPx, heightPx);
    if (!this.#frame || !isSameShape(this.#frame.shape, shape)) {
      // The new one first: where it does not fit, the old picture stays.
      const next = new FrameResources(device, pipelines, memory, shape);
      this.#frame?.destroy();
      this.#frame = next;
    }
    this.#resize(widthPx, heightPx);
    const frame = this.#frame;
    const projection = projectionOf(camera, widthPx, heightPx);
    frame.writeUniforms(viewUniforms(projection, shape), pageUniforms(viewFrame, projection, frame));

    this.#timer.begin();
    const encoder = device.createCommandEncoder({ label: 'websplatter frame' });
    recordFrame(encoder, pipelines, frame, this.#layer!.createView(), this.#timer);
    if (this.#canvas) this.#recordComposite(encoder, this.#canvas, viewFrame.background ?? [0, 0, 0]);
    this.#timer.record(encoder, frame.buffers);
    device.queue.submit([encoder.finish()]);
    this.#drawnKey = key;
    void this.#measure(frame.totalSplats);
  }

  async #measure(loadedSplats: number): Promise<void> {
    const statistics = await this.#timer.read(++this.#frameNumber, loadedSplats, this.#canvas !== null);
    if (!statistics || this.#isDestroyed) return;
    this.#statistics = statistics;
    this.onStatistics?.(statistics);
  }

  #recordComposite(encoder: GPUCommandEncoder, canvas: GPUCanvasContext, background: Vec3): void {
    const { device, pipelines } = this.#context;
    const parameters = new ArrayBuffer(CompositeParameters.bytes);
    CompositeParameters.write(parameters, { background });
    device.queue.writeBuffer(this.#compositeParameters, 0, parameters);
    this.#compositeGroup ??= pipelines.bindGroup(composite, {
      parameters: this.#compositeParameters,
      layer: this.#layer!.createView(),
    });
    const pass = encoder.beginRenderPass({
      label: 'composite',
      colorAttachments: [
        { view: canvas.getCurrentTexture().createView(), loadOp: 'clear', storeOp: 'store' },
      ],
      timestampWrites: this.#timer.writes('composite'),
    });
    pass.setPipeline(pipelines.render(composite, compositeState(this.#canvasFormat))!);
    pass.setBindGroup(0, this.#compositeGroup);
    pass.draw(3);
    pass.end();
  }

  #checkSize(widthPx: number, heightPx: number): void {
    const limit = this.#context.device.limits.maxTextureDimension2D;
    if (Math.max(widthPx, heightPx) > limit) {
      const message = `A picture of ${widthPx}×${heightPx} px is larger than this device's ${limit} px (maxTextureDimension2D).`;
      throw new InvalidArgumentError('widthPx', message);
    }
  }

  #resize(widthPx: number, heightPx: number): void {
    if (this.#layer?.width === widthPx && this.#layer.height === heightPx) return;
    const { memory, accuracy } = this.#context;
    if (this.#layer) memory.destroy(this.#layer);
    this.#compositeGroup = null;
    this.#layer = memory.createTexture({
      label: 'splat layer',
      size: { width: widthPx, height: heightPx },
      format: accuracy.colorTarget,
      usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_SRC,
    });
    if (this.#canvas) {
      this.#canvas.canvas.width = widthPx;
      this.#canvas.canvas.height = heightPx;
    }
  }

  #stagesFor(shape: FrameShape): ReturnType<typeof frameStages> {
    const stages = frameStages(shape);
    if (this.#canvas) stages.push([composite, compositeState(this.#canvasFormat)]);
    return stages;
  }

  #areCompiled(stages: readonly (StageDefinition | readonly [StageDefinition, RenderState])[]): boolean {
    const { pipelines } = this.#context;
    return stages.every((entry) =>
      'bindings' in entry ? pipelines.compute(entry) : pipelines.render(...entry),
    );
  }

  #checkUsable(): void {
    const reason = this.#isDestroyed ? 'it was destroyed' : this.#context.destroyedBecause();
    if (reason !== null) throw new DestroyedError('This view', reason);
  }
}

function configure(canvas: HTMLCanvasElement | OffscreenCanvas, device: GPUDevice, format: GPUTextureFormat) {
  const context = canvas.getContext('webgpu') as GPUCanvasContext | null;
  if (!context) {
    throw new InvalidArgumentError(
      'canvas',
      'The canvas already has a context of another kind; give the view one of its own.',
    );
  }
  context.configure({ device, format, alphaMode: 'opaque' });
  return context;
}

function isMatrix(values: ArrayLike<number>): boolean {
  return values.length === 16 && Array.prototype.every.call(values, Number.isFinite);
}

function checkFrame({ camera, clouds, widthPx, heightPx }: ViewFrame): void {
  if (!(Number.isInteger(widthPx) && Number.isInteger(heightPx) && widthPx >= 0 && heightPx >= 0)) {
    throw new InvalidArgumentError(
      'widthPx',
      `The picture is ${widthPx}×${heightPx}; it takes whole numbers of pixels.`,
    );
  }
  for (const name of ['viewMatrix', 'projectionMatrix'] as const) {
    if (!isMatrix(camera[name])) {
      throw new InvalidArgumentError(name, `The camera's ${name} must be 16 finite numbers, column-major.`);
    }
  }
  for (const { cloud, modelMatrix, opacity = 1 } of clouds) {
    if (cloud.isDestroyed) throw new DestroyedError(`The cloud ${cloud.name}`, 'it was destroyed');
    if (modelMatrix && !isMatrix(modelMatrix)) {
      const message = `The model matrix of ${cloud.name} must be 16 finite numbers, column-major.`;
      throw new InvalidArgumentError('modelMatrix', message);
    }
    if (!(opacity >= 0 && opacity <= 1)) {
      const message = `The opacity of ${cloud.name} is ${opacity}; it must lie in 0…1.`;
      throw new InvalidArgumentError('opacity', message);
    }
  }
}

const cloudNumbers = new WeakMap<SplatCloud, number>();
let cloudsSeen = 0;

/** Everything that the picture depends on, as text. */
function keyOf({ camera, clouds, widthPx, heightPx, background }: ViewFrame): string {
  const parts: unknown[] = [widthPx, heightPx, background, camera.near, camera.far];
  parts.push(Array.from(camera.viewMatrix), Array.from(camera.projectionMatrix));
  for (const { cloud, modelMatrix, opacity = 1 } of clouds) {
    if (!cloudNumbers.has(cloud)) cloudNumbers.set(cloud, ++cloudsSeen);
    parts.push(cloudNumbers.get(cloud), modelMatrix && Array.from(modelMatrix), opacity);
  }
  return JSON.stringify(parts);
}

/** @param current shape of the last picture: its buffers are kept as long as they are large enough. */
function shapeOf(
  frame: ViewFrame,
  { accuracy, dispatchRow }: ViewContext,
  current: FrameShape | undefined,
): FrameShape {
  const { camera } = frame;
  const clouds = frame.clouds.map(({ cloud }) => cloud);
  const isSameClouds =
    clouds.length === current?.clouds.length && clouds.every((cloud, i) => cloud === current.clouds[i]);
  return {
    clouds,
    isOrthographic: camera.projectionMatrix[11] === 0,
    accuracy,
    dispatchRow,
    visibleCapacity: visibleCapacity(frame, accuracy.alphaCutoff, isSameClouds ? current.visibleCapacity : 0),
    keyBits: keyBitsFor(camera, frame.clouds),
  };
}

function isSameShape(a: FrameShape, b: FrameShape): boolean {
  return (
    a.isOrthographic === b.isOrthographic &&
    a.keyBits === b.keyBits &&
    a.visibleCapacity === b.visibleCapacity &&
    a.accuracy === b.accuracy &&
    a.clouds.length === b.clouds.length &&
    a.clouds.every((cloud, i) => cloud === b.clouds[i])
  );
}
