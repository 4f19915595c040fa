import { perspectiveCamera } from '../camera/camera.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { InvalidArgumentError } from '../errors.ts';
import type { Destination } from '../frame/frame-part.ts';
import type { FramePlan } from '../frame/frame-plan.ts';
import type { FrameRequest } from '../frame/frame-request.ts';
import type { TextureImage } from '../gpu/read-texture.ts';
import type { Vec3 } from '../math/mat4.ts';
import type { AccuracyChoice } from '../measure/choose-accuracy.ts';
import { storableCanvasFormat } from '../stages/composite.ts';
import type { FrameProfile } from '../timing/frame-profile.ts';
import type { ChooseAccuracyOptions } from './accuracy-wishes.ts';
import type { SplatPick } from './pick-splat.ts';
import { type ViewContext, ViewCore } from './view-core.ts';

const BLACK: Vec3 = [0, 0, 0];

// Of a size and of depths, only orders of magnitude matter to shaders.
const LIKELY_SIZE = { widthPx: 1920, heightPx: 1080 };
const LIKELY_CAMERA = perspectiveCamera({
  position: [0, 0, 1],
  target: [0, 0, 0],
  fovYDegrees: 60,
  aspect: LIKELY_SIZE.widthPx / LIKELY_SIZE.heightPx,
});

/** Draws clouds whenever something has changed: on a canvas, or into a texture that can be read back. */
export class SplatView extends ViewCore {
  /** @internal Splits frames into their passes and times those; such frames have no statistics. Null for whole frames. */
  profile: FrameProfile | null = null;
  readonly #canvas: GPUCanvasContext | null;
  /** Background of the image on the canvas. */
  #shownBackground: readonly number[] = BLACK;

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
    super(context, output, () => onDestroyed(this));
    this.#canvas = configured;
  }

  /**
   * Draws `request`: submits the GPU's work and returns at once. If camera, clouds, size, background and accuracy are those
   * of the last frame, nothing is submitted. If a shader is still compiling, the frame follows automatically when it is
   * ready; until then the same clouds are drawn with their old settings and effects. `whenDrawn` waits for the frame.
   *
   * If memory turns out to be lacking, which the device tells some time later, the picture before is drawn again, `whenDrawn`
   * rejects, and so does the next call, once. Later calls look for memory and draw when there is some.
   *
   * @returns whether work was, or will be, submitted.
   * @throws InvalidArgumentError, GpuLimitError, DestroyedError.
   */
  render(request: FrameRequest): boolean {
    this.checkUsable();
    if (!this.check(request)) return false;
    const { plan, stands, isAsked } = this.next(request, [null]);
    if (!isAsked) {
      if (plan && !stands) this.#draw(plan);
      return !this.isLackingRoom;
    }
    const isChanged = !stands || !this.#showsBackground(request);
    if (!stands) this.#draw(plan!);
    else if (isChanged) this.#drawBackground(request);
    if (stands) this.shown(request);
    return isChanged;
  }

  /** @internal Compiles the shaders that the first frame of such a cloud alone is likely to need. */
  expectCloud(cloud: SplatCloud): void {
    this.foresee({ camera: LIKELY_CAMERA, clouds: [{ cloud }], ...LIKELY_SIZE });
  }

  /**
   * Resolves when the last requested frame has been submitted and the device has had memory for it. Rejects with a GpuLimitError
   * if it has not, and if shaders do not compile.
   */
  whenDrawn(): Promise<void> {
    return this.drawn;
  }

  /**
   * Reads back the last image, without its background: premultiplied RGBA in the space that splats are blended in
   * (sRGB-encoded), top row first, 4·width·height values.
   */
  async readPixels(): Promise<TextureImage> {
    // Most pages never do.
    const { readTexture } = await import('../gpu/read-texture.ts');
    await this.whenDrawn();
    this.checkUsable();
    const { image } = this.parts.shared;
    if (!image) throw new InvalidArgumentError('readPixels', 'There is no frame yet: call render first.');
    this.context.counting.readbacks++;
    return readTexture(this.context.device, image.color);
  }

  override async pick(xPx: number, yPx: number): Promise<SplatPick | null> {
    await this.whenDrawn();
    return super.pick(xPx, yPx);
  }

  override async chooseAccuracy(options: ChooseAccuracyOptions = {}): Promise<AccuracyChoice> {
    await this.whenDrawn();
    return super.chooseAccuracy(options);
  }

  /** @internal The texture of the last image, for comparisons on the GPU: see measure/. */
  blended(): { readonly context: ViewContext; readonly color: GPUTexture | null } {
    this.checkUsable();
    return { context: this.context, color: this.parts.shared.image?.color ?? null };
  }

  /** Frees the view's GPU memory; the clouds stay. */
  destroy(): void {
    if (!this.end()) return;
    this.#canvas?.unconfigure();
    this.free();
  }

  protected override onChosen(choice: AccuracyChoice, request: FrameRequest): void {
    try {
      // A request that waits for shaders is drawn with the choice anyway.
      if (!this.isWaiting && this.canStillDraw(request)) this.render({ ...request, force: false });
    } catch (error) {
      console.warn(`The chosen settings could not be drawn; the image stays. ${(error as Error).message}`);
    }
    this.onAccuracyChosen?.(choice);
  }

  protected override retry(request: FrameRequest | null): void {
    if (request && this.canStillDraw(request)) this.render(request);
  }

  protected override redraw(plan: FramePlan): void {
    this.#draw(plan);
  }

  #draw(plan: FramePlan): void {
    const { device } = this.context;
    const { request } = plan;
    this.withMemory(plan, () => {
      this.makeRoom(plan);
      this.#fitCanvas(request);
      if (!this.profile) this.timer.begin();
      const whole = device.createCommandEncoder({ label: 'websplatter frame' });
      const encoder = this.profile?.split(whole) ?? whole;
      this.recordOrder(encoder);
      this.recordDraw(encoder, this.#destination(request));
      device.queue.submit([encoder.finish()]);
    });
    this.shown(request);
    void this.measure();
  }

  /** Draws the last splats over another background. */
  #drawBackground(request: FrameRequest): void {
    const { device } = this.context;
    const encoder = device.createCommandEncoder({ label: 'websplatter background' });
    this.parts.recordBackground(encoder, this.timer, this.#destination(request));
    device.queue.submit([encoder.finish()]);
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
