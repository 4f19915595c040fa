import { DestroyedError, InvalidArgumentError } from '../errors.ts';
import { frameStages } from '../frame/frame.ts';
import { checkFrame, keysOf, type ViewFrame } from '../frame/frame-request.ts';
import type { FrameShape, OmittableEffect } from '../frame/frame-shape.ts';
import type { CompiledStage } from '../gpu/pipelines.ts';
import { readTexture, type TextureImage } from '../gpu/read-texture.ts';
import { CompositeParameters } from '../layout/structs.ts';
import type { EffectEntry } from '../ledger/ledger.ts';
import type { Vec3 } from '../math/mat4.ts';
import type { AccuracyChoice } from '../measure/choose-accuracy.ts';
import { composite, compositeState } from '../stages/composite.ts';
import type { FrameStatistics } from '../timing/frame-statistics.ts';
import type { ChooseAccuracyOptions } from './accuracy-wishes.ts';
import { BlendedLayer, type FramePlan, type ViewContext } from './blended-layer.ts';
import type { SplatPick } from './pick-splat.ts';
import { ViewAccuracy } from './view-accuracy.ts';

/** One picture of some clouds, drawn again whenever something has changed: on a canvas, or to be read back. */
export class SplatView {
  /** Called some frames after each picture that was measured. */
  onStatistics: ((statistics: FrameStatistics) => void) | null = null;
  /**
   * Called when settings have been chosen because of a wish (`accuracy: { minPsnrDb: 45 }`), which takes seconds and begins
   * half a second after the first picture, and after the last change of its size. It is measured again for other clouds,
   * and not because the camera moves. The last picture is drawn again with them by then.
   */
  onAccuracyChosen: ((choice: AccuracyChoice) => void) | null = null;
  readonly #context: ViewContext;
  readonly #canvas: GPUCanvasContext | null;
  readonly #canvasFormat: GPUTextureFormat;
  readonly #layer: BlendedLayer;
  readonly #accuracy: ViewAccuracy;
  readonly #compositeParameters: GPUBuffer;
  readonly #onDestroyed: (view: SplatView) => void;
  #compositeGroup: GPUBindGroup | null = null;
  /** The background that the canvas shows. */
  #shownBackground: readonly number[] = BLACK;
  /** What is drawn as soon as its shaders are there: one object until then, with the last frame that was asked for. */
  #waiting: { frame: ViewFrame } | null = null;
  #whenDrawn: Promise<void> = Promise.resolve();
  #statistics: FrameStatistics | null = null;
  #isDestroyed = false;

  /**
   * @internal Use `engine.createView`.
   * @param onDestroyed called when the view has been destroyed.
   */
  constructor(
    context: ViewContext,
    canvas: HTMLCanvasElement | OffscreenCanvas | null,
    canvasFormat: GPUTextureFormat,
    onDestroyed: (view: SplatView) => void,
  ) {
    this.#context = context;
    this.#canvasFormat = canvasFormat;
    this.#canvas = canvas && configure(canvas, context.device, canvasFormat);
    this.#layer = new BlendedLayer(context);
    this.#accuracy = new ViewAccuracy(context, (choice, picture) => this.#showChoice(choice, picture));
    this.#onDestroyed = onDestroyed;
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

  /** What is drawn because of a wish; null before the first choice, and where settings are asked for. */
  get accuracyChoice(): AccuracyChoice | null {
    return this.#accuracy.choice;
  }

  /**
   * Draws `frame`: submits the GPU's work and returns at once. Where camera, clouds, size, background and accuracy are
   * those of the last picture nothing is submitted. Where a shader is still being compiled, the picture follows by itself when
   * it is ready; until then the same clouds are drawn as before, with their old settings and effects. `whenDrawn` waits.
   *
   * @returns whether anything was, or will be, submitted.
   * @throws InvalidArgumentError, GpuLimitError, DestroyedError.
   */
  render(frame: ViewFrame): boolean {
    this.#checkUsable();
    checkFrame(frame, this.#context.device);
    if (frame.widthPx === 0 || frame.heightPx === 0) return false;
    const settings = this.#accuracy.settingsFor(frame);
    const keys = keysOf(frame, settings);
    if (!frame.force && !this.#waiting && this.#layer.isPrepared(keys)) {
      const { background = BLACK } = frame;
      const isSame = background.every((value, i) => value === this.#shownBackground[i]);
      if (!isSame) this.#show(frame);
      this.#whenDrawn = Promise.resolve();
      this.#accuracy.show(frame);
      return !isSame;
    }
    const plan = this.#layer.planFor(frame, keys, settings);
    const isReady = this.#context.pipelines.areReady(this.#stagesFor(plan.shape));
    const stopgap = isReady ? null : this.#layer.stopgapFor(plan);
    if (isReady) this.#draw(plan);
    else if (stopgap && !this.#layer.isPrepared(stopgap.keys)) this.#draw(stopgap);
    if (isReady) {
      this.#waiting = null;
      this.#whenDrawn = Promise.resolve();
    } else if (this.#waiting) {
      this.#waiting.frame = frame;
    } else {
      this.#waiting = { frame };
      this.#whenDrawn = this.#drawWaiting(this.#waiting);
      // Who does not wait for the picture still hears of a shader that does not compile, once, by the device's own error.
      this.#whenDrawn.catch(() => {});
    }
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
    const { color } = this.#layer;
    if (!color) throw new InvalidArgumentError('readPixels', 'There is no picture yet: call render first.');
    this.#context.counting.readbacks++;
    return readTexture(this.#context.device, color);
  }

  /**
   * The splat that contributes most to a pixel of the last picture; null where there is none, outside of the picture, and
   * before the first.
   *
   * @param xPx, yPx from the top left; fractions fall to the pixel that they are in.
   * @throws DestroyedError where the view or its engine end meanwhile.
   */
  async pick(xPx: number, yPx: number): Promise<SplatPick | null> {
    await this.#whenDrawn;
    this.#checkUsable();
    return this.#layer.pick(xPx, yPx);
  }

  /**
   * Measures now what the last picture shows, and chooses anew what meets its wish: for all views with the same wish and
   * the same clouds, at the size of the largest.
   *
   * @throws InvalidArgumentError where there is no picture, or it was drawn without a wish; DestroyedError; an AbortError
   *   where the view is destroyed or a later call takes over; the signal's reason. What was drawn before stays then.
   */
  async chooseAccuracy(options: ChooseAccuracyOptions = {}): Promise<AccuracyChoice> {
    await this.#whenDrawn;
    this.#checkUsable();
    return this.#accuracy.choose(options);
  }

  /**
   * All effects of the last picture, also those that were off, and why; none before the first picture. While shaders for
   * other effects are being compiled that picture has the old ones.
   */
  effects(): readonly EffectEntry[] {
    return this.#layer.effects();
  }

  /** @internal Draws what follows without these, for measurements of what they cost. */
  omitEffects(effects: readonly OmittableEffect[]): void {
    this.#layer.omittedEffects = effects;
  }

  /** @internal Number of the last picture among all that the engine has drawn; 0 before the first. */
  get drawnAs(): number {
    return this.#layer.drawnAs;
  }

  /** @internal What the last picture was blended in, for comparisons that stay on the GPU: see measure/. */
  blended(): { readonly context: ViewContext; readonly color: GPUTexture | null } {
    this.#checkUsable();
    return { context: this.#context, color: this.#layer.color };
  }

  /** @internal Of the last picture; null before the first. */
  get shape(): FrameShape | null {
    return this.#layer.frame?.shape ?? null;
  }

  /** Frees what the view holds on the GPU; the clouds stay. */
  destroy(): void {
    if (this.#isDestroyed) return;
    this.#isDestroyed = true;
    this.#waiting = null;
    this.#accuracy.leave();
    this.#canvas?.unconfigure();
    this.#layer.destroy();
    this.#context.memory.destroy(this.#compositeParameters);
    this.#onDestroyed(this);
  }

  /** Compiles what `waiting` needs, which may have another frame by then, and draws it if nothing was drawn meanwhile. */
  async #drawWaiting(waiting: { readonly frame: ViewFrame }): Promise<void> {
    try {
      while (this.#waiting === waiting && this.#canStillDraw(waiting.frame)) {
        const { frame } = waiting;
        const settings = this.#accuracy.settingsFor(frame);
        const plan = this.#layer.planFor(frame, keysOf(frame, settings), settings);
        const stages = this.#stagesFor(plan.shape);
        if (this.#context.pipelines.areReady(stages)) {
          this.#waiting = null;
          this.#draw(plan);
        } else {
          await this.#context.pipelines.prepare(stages);
        }
      }
    } finally {
      if (this.#waiting === waiting) this.#waiting = null;
    }
  }

  #canStillDraw({ clouds }: ViewFrame): boolean {
    const isUsable = !this.#isDestroyed && this.#context.destroyedBecause() === null;
    return isUsable && clouds.every(({ cloud }) => !cloud.isDestroyed);
  }

  #draw(plan: FramePlan): void {
    const { device } = this.#context;
    const layer = this.#layer;
    const { frame } = plan;
    if (layer.update(plan)) {
      this.#compositeGroup = null;
      if (this.#canvas) {
        this.#canvas.canvas.width = frame.widthPx;
        this.#canvas.canvas.height = frame.heightPx;
      }
    }
    layer.timer.begin();
    const encoder = device.createCommandEncoder({ label: 'websplatter frame' });
    layer.recordCompute(encoder);
    layer.recordRasterize(encoder, null);
    this.#recordComposite(encoder, frame);
    layer.recordTimes(encoder);
    device.queue.submit([encoder.finish()]);
    this.#accuracy.show(frame);
    void this.#measure();
  }

  /** Puts the splats that stand over another background. */
  #show(frame: ViewFrame): void {
    const encoder = this.#context.device.createCommandEncoder({ label: 'websplatter background' });
    this.#recordComposite(encoder, frame);
    this.#context.device.queue.submit([encoder.finish()]);
  }

  async #measure(): Promise<void> {
    const statistics = await this.#layer.measure();
    if (!statistics || this.#isDestroyed) return;
    this.#statistics = statistics;
    this.onStatistics?.(statistics);
  }

  #recordComposite(encoder: GPUCommandEncoder, frame: ViewFrame): void {
    const { background = BLACK } = frame;
    // A copy: callers may change theirs.
    this.#shownBackground = [...background];
    const canvas = this.#canvas;
    if (!canvas) return;
    const { device, pipelines } = this.#context;
    const parameters = new ArrayBuffer(CompositeParameters.bytes);
    CompositeParameters.write(parameters, { background });
    device.queue.writeBuffer(this.#compositeParameters, 0, parameters);
    this.#compositeGroup ??= pipelines.bindGroup(composite, {
      parameters: this.#compositeParameters,
      layer: this.#layer.color!.createView(),
    });
    const pass = encoder.beginRenderPass({
      label: 'composite',
      colorAttachments: [
        { view: canvas.getCurrentTexture().createView(), loadOp: 'clear', storeOp: 'store' },
      ],
      timestampWrites: this.#layer.timer.writes('composite'),
    });
    pass.setPipeline(pipelines.render(composite, compositeState(this.#canvasFormat))!);
    pass.setBindGroup(0, this.#compositeGroup);
    pass.draw(3);
    pass.end();
  }

  /** @param picture the last one that stands. */
  #showChoice(choice: AccuracyChoice, picture: ViewFrame): void {
    try {
      // What waits is drawn with the choice anyway.
      if (!this.#waiting && this.#canStillDraw(picture)) this.render({ ...picture, force: false });
    } catch (error) {
      console.warn(`What was chosen could not be drawn; the picture stays. ${(error as Error).message}`);
    }
    this.onAccuracyChosen?.(choice);
  }

  #stagesFor(shape: FrameShape): CompiledStage[] {
    const stages = frameStages(shape);
    if (this.#canvas) stages.push([composite, compositeState(this.#canvasFormat)]);
    return stages;
  }

  #checkUsable(): void {
    const reason = this.#isDestroyed ? 'it was destroyed' : this.#context.destroyedBecause();
    if (reason !== null) throw new DestroyedError('This view', reason);
  }
}

const BLACK: Vec3 = [0, 0, 0];

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
