import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { perspectiveCamera } from '../data/camera/camera.ts';
import { fetched, InvalidArgumentError } from '../data/errors.ts';
import { callListener } from '../data/listeners.ts';
import type { Vec3 } from '../data/math/mat4.ts';
import type { FrameParts } from '../frame/frame.ts';
import type { Destination } from '../frame/parts/frame-part.ts';
import type { FramePlan } from '../frame/plan/frame-plan.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import type { TextureImage } from '../gpu/read-texture.ts';
import type { FrameProfile } from '../gpu/timing/frame-profile.ts';
import type { AccuracyChoice } from '../measure/choose-accuracy.ts';
import { storableCanvasFormat } from '../stages/composite/composite.ts';
import type { ChooseAccuracyOptions } from './accuracy-targets.ts';
import type { FrameDivider } from './frame-divider.ts';
import type { SplatPick } from './pick-splat.ts';
import { SubmissionForecast } from './submission-forecast.ts';
import { View } from './view.ts';
import { RESOLVED, type ViewContext, ViewFrames } from './view-frames.ts';

const BLACK: Vec3 = [0, 0, 0];

// Only orders of magnitude of size and depths matter to shaders.
const LIKELY_SIZE = { widthPx: 1920, heightPx: 1080 };
const LIKELY_CAMERA = perspectiveCamera({
  position: [0, 0, 1],
  target: [0, 0, 0],
  fovYDegrees: 60,
  aspect: LIKELY_SIZE.widthPx / LIKELY_SIZE.heightPx,
});

/** Draws clouds whenever a request changes them: on a canvas, or into a texture for read-back. */
export class SplatView extends View {
  /**
   * @internal Splits frames into timed passes; such frames have no statistics. Null for whole
   *   frames.
   */
  profile: FrameProfile | null = null;
  readonly #canvas: GPUCanvasContext | null;
  /** Background of the canvas's current image. */
  #shownBackground: readonly number[] = BLACK;
  #forecast: SubmissionForecast;
  /** Created for the first frame that is submitted in parts. */
  #divider: FrameDivider | null = null;
  /**
   * Parts of the frame that is being submitted in parts, whose buffers must not change; else null.
   */
  #inParts: FrameParts | null = null;
  /** Whether the last frame was abandoned midway, so that only its image is usable. */
  #isUnfinished = false;

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
    const configured = canvas && configure(canvas, context.device, canvasFormat);
    const output = canvas
      ? ({
          kind: 'canvas',
          format: canvasFormat,
          storable: storableCanvasFormat(context.device, canvasFormat),
        } as const)
      : ({ kind: 'image' } as const);
    const drawing = {
      draw: (plan: FramePlan) => this.#draw(plan),
      drawAgain: (request: FrameRequest) => this.#drawAgain(request),
      drawWaiting: (request: FrameRequest | null) => {
        // A newer request is drawn after the frame in parts.
        if (this.frames.wait.reason === 'parts') return RESOLVED;
        // Callers that await the frame get the error if a cloud has been destroyed meanwhile.
        return request && this.#drawWaiting(request);
      },
      // `whenDrawn` and the next call throw it.
      onFault: () => {},
    };
    super(new ViewFrames(context, output, drawing, () => onDestroyed(this)));
    this.#canvas = configured;
    this.#forecast = new SubmissionForecast(context.submissionBudgetMs);
  }

  /**
   * Draws `request`: submits the GPU's work and returns at once. Nothing is submitted if camera,
   * clouds, size, background and accuracy equal the last frame's. If shaders are still compiling,
   * the frame is drawn automatically once they are ready; until then the same clouds are drawn with
   * their old settings and effects. A frame that may keep the GPU for long is submitted in parts;
   * the newest of later requests is drawn next. `whenDrawn` waits for the frame.
   *
   * The device reports a lack of memory later. Then the previous image is drawn again, `whenDrawn`
   * rejects, and the next call throws, once. Later calls probe for memory and draw when there is
   * enough. So it is with an effect whose shader has an error, or whose texture or buffer is destroyed:
   * the frame is drawn without that effect, `whenDrawn` rejects, and the next call throws, once.
   *
   * @returns whether work was, or will be, submitted.
   * @throws InvalidArgumentError, GpuLimitError, DestroyedError, ShaderError, CodeUnavailableError.
   */
  render(request: FrameRequest): boolean {
    this.frames.checkUsable();
    this.frames.throwReceived();
    return this.#request(request);
  }

  /** Like `render`, but without throwing errors of earlier frames. */
  #request(request: FrameRequest): boolean {
    const { frames } = this;
    frames.checkUsable();
    if (!frames.check(request)) return false;
    if (this.#inParts === frames.parts) {
      // The frame in parts reports its own error.
      frames.waitFor(request, 'parts', () => frames.lastDrawn.catch(() => {}));
      return true;
    }
    const { plan, isDrawn, status } = frames.next(request, [null]);
    if (plan && !isDrawn) this.#draw(plan);
    if (status !== 'ready') return status === 'waiting';
    if (!isDrawn) return true;
    const isChanged = !this.#showsBackground(request);
    if (isChanged) this.#drawBackground(request);
    frames.onDrawn(request);
    return isChanged;
  }

  /** Draws a request that had to wait. Settles when it is drawn. */
  #drawWaiting(request: FrameRequest): Promise<void> {
    this.frames.waiting = null;
    this.#request(request);
    return this.frames.drawn;
  }

  /** @internal Compiles the shaders that the first frame of this cloud alone is likely to need. */
  expectCloud(cloud: SplatCloud): void {
    this.frames.precompile({ camera: LIKELY_CAMERA, clouds: [{ cloud }], ...LIKELY_SIZE });
  }

  /**
   * Resolves when the last requested frame has been submitted and the device has confirmed memory
   * for it. Rejects with a GpuLimitError if memory was lacking; with a ShaderError if a shader cannot be
   * linked or compiled; with a CodeUnavailableError if code for it cannot be fetched; with a
   * DestroyedError if one of its clouds, a resource of its effects, the view, the engine or the device
   * ends before.
   */
  async whenDrawn(): Promise<void> {
    const { frames } = this;
    let awaited: Promise<void>;
    do {
      awaited = frames.drawn;
      await awaited;
      // A frame in parts may have been abandoned for a newer request without leaving an image.
    } while (!frames.last && frames.drawn !== awaited);
    frames.throwKept();
  }

  /**
   * Reads back the last image without its background. Premultiplied RGBA in the space that splats
   * are blended in (sRGB-encoded), top row first, 4·width·height values.
   *
   * @throws InvalidArgumentError before the first frame; DestroyedError if the view, its engine or
   *   the device ends before the image is read; the errors of `whenDrawn`.
   */
  async readPixels(): Promise<TextureImage> {
    // Fetched on demand, because most pages never read pixels.
    const { readTexture } = await fetched('read-back', import('../gpu/read-texture.ts'));
    await this.whenDrawn();
    const { context, parts } = this.frames;
    this.frames.checkUsable();
    const { image } = parts.shared.resources;
    if (!image) throw new InvalidArgumentError('readPixels', 'There is no frame yet: call render first.');
    context.counting.readbacks++;
    return readTexture(context.device, image);
  }

  override async pick(xPx: number, yPx: number): Promise<SplatPick | null> {
    await this.whenDrawn();
    return super.pick(xPx, yPx);
  }

  override async chooseAccuracy(options: ChooseAccuracyOptions = {}): Promise<AccuracyChoice> {
    await this.whenDrawn();
    return super.chooseAccuracy(options);
  }

  /** @internal Texture and buffers of the last image, for measure/ and inspect/. */
  blended(): {
    readonly context: ViewContext;
    readonly color: GPUTexture | null;
    readonly parts: FrameParts;
  } {
    this.frames.checkUsable();
    const { context, parts } = this.frames;
    return { context, color: parts.shared.resources.image ?? null, parts };
  }

  /** Frees the view's GPU memory; the clouds stay. */
  destroy(): void {
    if (!this.frames.end()) return;
    this.frames.parts.destroy();
    // The canvas belongs to the caller.
    callListener(() => this.#canvas?.unconfigure());
  }

  #drawAgain(request: FrameRequest): void {
    const { frames } = this;
    try {
      // A waiting request will be drawn with the new settings anyway.
      if (!frames.wait.reason && frames.canStillDraw(request)) this.#request({ ...request, force: false });
    } catch (error) {
      console.warn(
        `The settings found could not be drawn with; the image stays. ${(error as Error).message}`,
      );
    }
  }

  #draw(plan: FramePlan): Promise<void> {
    const { frames, profile } = this;
    const { request } = plan;
    if (this.#isUnfinished) frames.startOver();
    this.#isUnfinished = false;
    const { parts } = frames;
    if (!profile && this.#forecast.mayExceed(plan)) {
      const checked = frames.submit(plan, () => parts.timer.begin());
      this.#inParts = parts;
      frames.lastDrawn = this.#drawInParts(plan, checked);
      // Only callers that await the frame get the error, as with shaders that do not compile.
      frames.lastDrawn.catch(() => {});
      return frames.lastDrawn;
    }
    const drawn = frames.submit(plan, () => {
      this.#fitCanvas(request);
      (profile ?? parts.timer).begin();
      const passes = [...frames.orderPasses(), ...frames.drawPasses(this.#destination(request))];
      frames.run('websplatter frame', (encoder) => {
        if (profile) for (const pass of passes) profile.record(encoder, pass);
        else parts.record(encoder, passes);
        frames.recordEnd(encoder);
        profile?.end(encoder);
      });
    });
    frames.onDrawn(request);
    void frames.measure().then((measured) => measured && this.#forecast.take(plan, measured.timing));
    return drawn;
  }

  /** @param checked settles when the device has confirmed memory for the frame's buffers. */
  async #drawInParts(plan: FramePlan, checked: Promise<void>): Promise<void> {
    const { frames } = this;
    const { parts } = frames;
    const { request } = plan;
    // Errors within parts are not caught, so parts are submitted only once their buffers exist.
    await checked;
    // Another frame has replaced it.
    if (parts !== frames.parts) return;
    // Errors of parts do not tell of the resources that effects read.
    if (await frames.findRefused(plan)) {
      this.#inParts = null;
      frames.lastDrawn = RESOLVED;
      return this.#drawWaiting(request);
    }
    const isDrawn = await this.#submitInParts(plan).catch((error: Error) => error);
    this.#inParts = null;
    if (isDrawn instanceof Error) return frames.recovery.giveUp(plan, parts, isDrawn);
    if (isDrawn) return;
    if (!frames.isDestroyed && parts === frames.parts) {
      // A held preview is not drawn again; its image stays until another cloud replaces it.
      this.#isUnfinished = request.clouds.some(({ cloud }) => cloud.isHeld);
      if (!this.#isUnfinished) frames.startOver();
    }
    if (frames.wait.reason === 'parts') return;
    // `#drawWaiting` may return `lastDrawn`, which is the promise of this function.
    frames.lastDrawn = RESOLVED;
    // Callers that await the frame get the error if a resource of it has been destroyed.
    return this.#drawWaiting(request);
  }

  /** Returns whether the frame was drawn. */
  async #submitInParts(plan: FramePlan): Promise<boolean> {
    const { frames } = this;
    const { parts, context } = frames;
    const { request, shape } = plan;
    if (!this.#divider) {
      // Fetched on demand, because small scenes never need it.
      const module = await import('./frame-divider.ts').catch(() => null);
      if (!module) {
        // Without the code, frames are drawn whole, even if slowly.
        this.#forecast = new SubmissionForecast(Number.POSITIVE_INFINITY);
        return false;
      }
      this.#divider = new module.FrameDivider(context);
    }
    const submittedMs = performance.now();
    const canDraw = () =>
      !frames.isDestroyed &&
      context.destroyedBecause() === null &&
      parts === frames.parts &&
      !parts.isDestroyed;
    const submitted = this.#divider.submit({
      parts,
      plan,
      orderPasses: frames.orderPasses(),
      recordEnd: (encoder) => {
        // Resizing a canvas clears it, so it is done just before drawing.
        this.#fitCanvas(request);
        parts.record(encoder, parts.backgroundPasses(this.#destination(request)));
        frames.recordEnd(encoder);
      },
      canOrder: () =>
        canDraw() &&
        shape.clouds.every(({ cloud, planes, levels }) => {
          const areThere = cloud.pagesFor(planes) === planes && (!levels || cloud.levels === levels);
          return !cloud.isDestroyed && !cloud.isHeld && areThere;
        }),
      canDraw,
    });
    frames.streams.deferUploads(submitted);
    const elapsedMs = await submitted;
    if (elapsedMs === null) return false;
    this.#forecast.takeParts(plan, elapsedMs);
    frames.onDrawn(request);
    void frames.measure(submittedMs);
    return true;
  }

  /** Draws the last splats over another background. */
  #drawBackground(request: FrameRequest): void {
    const { parts } = this.frames;
    this.frames.run('websplatter background', (encoder) =>
      parts.record(encoder, parts.backgroundPasses(this.#destination(request))),
    );
  }

  #showsBackground({ background = BLACK }: FrameRequest): boolean {
    return background.every((value, i) => value === this.#shownBackground[i]);
  }

  #fitCanvas({ widthPx, heightPx }: FrameRequest): void {
    const canvas = this.#canvas?.canvas;
    if (!canvas || (canvas.width === widthPx && canvas.height === heightPx)) return;
    canvas.width = widthPx;
    canvas.height = heightPx;
  }

  #destination({ background = BLACK }: FrameRequest): Destination {
    // Copied, because callers may change their array.
    this.#shownBackground = [...background];
    return this.#canvas ? { kind: 'canvas', canvas: this.#canvas, background } : { kind: 'image' };
  }
}

function configure(canvas: HTMLCanvasElement | OffscreenCanvas, device: GPUDevice, format: GPUTextureFormat) {
  const context = canvas.getContext('webgpu') as GPUCanvasContext | null;
  if (!context) {
    throw new InvalidArgumentError(
      'canvas',
      'The canvas already has a context of another kind; give the view its own canvas.',
    );
  }
  const usage =
    GPUTextureUsage.RENDER_ATTACHMENT |
    (storableCanvasFormat(device, format) ? GPUTextureUsage.STORAGE_BINDING : 0);
  context.configure({ device, format, usage, alphaMode: 'opaque' });
  return context;
}
