import type { SplatCloud } from '../clouds/splat-cloud.ts';
import type { DepthConvention } from '../data/camera/depth-convention.ts';
import { DestroyedError, InvalidArgumentError } from '../data/errors.ts';
import { given } from '../data/given.ts';
import { callListener } from '../data/listeners.ts';
import type { HostPass } from '../frame/parts/frame-part.ts';
import type { EmbeddedImage } from '../frame/parts/host-textures.ts';
import type { FramePlan } from '../frame/plan/frame-plan.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import type { FrameShape } from '../frame/plan/frame-shape.ts';
import type { RasterizeDepth } from '../stages/quads/quads.ts';
import { View } from './view.ts';
import { type PossibleDepths, type ViewContext, ViewFrames } from './view-frames.ts';

/** A frame request of an embedded view. */
export interface EmbeddedFrameRequest
  extends Pick<
    FrameRequest,
    'camera' | 'clouds' | 'widthPx' | 'heightPx' | 'accuracy' | 'sortBy' | 'detail'
  > {
  /** How the host stores depth. Absent: nothing hides splats. */
  readonly depth?: DepthConvention;
  /**
   * Whether the host's depth may contain objects that hide splats. If false, splats are drawn
   * without a depth test. May change from frame to frame. Default: true.
   */
  readonly hasOccluders?: boolean;
  /**
   * Whether the image includes the splats' depth; requires `depth`. The rasteriser `auto` then
   * prefers tiles. Default: false.
   */
  readonly writesDepth?: boolean;
  /**
   * Share of the splats' finished picture that is blended over the host's image, 0…1: in sRGB's
   * encoding, the image is the mean of the images with and without splats, weighted by `fade` and 1 −
   * `fade`. Applies to all clouds of the frame together, because they are sorted and blended as one;
   * for a cloud alone, use another view. Depths, picks and the cost of a frame stay as they are, but
   * depth is written only where the faded splats cover half of a pixel. Default: 1.
   */
  readonly fade?: number;
}

/**
 * Splats inside another renderer's frame, hidden by its meshes and blended over its image, in the
 * colour space that splats are trained in. The host ends its pass and lets this view record into
 * its encoder. Its next pass shows the view's image, which is opaque where there are splats, unless
 * the view writes it into the host's (`HostPass.writesColor`).
 *
 * `prepare` makes one submission, and the host submits `draw`, however long they take: only
 * `SplatView` divides long frames (`EngineOptions.submissionBudgetMs`). On slow devices, request a
 * smaller `resolutionScale`, or `{ maxFrameMs }`.
 */
export class EmbeddedView extends View {
  /** Called when missing shaders, accuracy or detail are ready: prepare the frame again. */
  onReady: (() => void) | null = null;
  /**
   * Called once for an error of a frame after it was prepared, with the clouds that are concerned: a
   * ShaderError or, if the device has refused a texture or buffer of an effect, a DestroyedError or an
   * InvalidArgumentError, where the clouds are drawn without the effect; a CodeUnavailableError, or a
   * ShaderError of a shader without effects, where the last image stays. Null: the next call of `prepare`
   * throws the error.
   */
  onFault: ((error: Error, clouds: readonly SplatCloud[]) => void) | null = null;
  /** The last shape whose variant with occluders has been compiled; null before the first. */
  #precompiled: FrameShape | null = null;
  /** Whether the prepared frame has been drawn. */
  #isDrawn = false;

  /**
   * @internal Use `engine.createEmbeddedView`.
   * @param onDestroyed called when the view has been destroyed.
   */
  constructor(context: ViewContext, onDestroyed: (view: EmbeddedView) => void) {
    const drawing = {
      draw: (plan: FramePlan) => this.#prepare(plan),
      drawAgain: () => this.#askAgain(),
      // The host may have drawn a subset of the clouds meanwhile, so it has to prepare again.
      drawWaiting: () => {
        this.#askAgain();
        return null;
      },
      onFault: () => this.#askAgain(),
    };
    super(new ViewFrames(context, { kind: 'host' }, drawing, () => onDestroyed(this)));
  }

  /**
   * The image of the last `draw` if it shows the prepared frame; null if the frame is yet to be drawn.
   * Its colours are over the host's image of that time. Its depth is still right if the frame was
   * prepared with `hasOccluders: false`.
   */
  get drawnImage(): EmbeddedImage | null {
    return this.#isDrawn ? this.frames.parts.host.image : null;
  }

  /**
   * Finds and sorts the visible splats. Submits this work at once; submits nothing if camera,
   * clouds, size and accuracy equal the last frame's.
   *
   * @returns whether there is something to draw. False without clouds or pixels, after the loss of
   *   the device, and while shaders compile, unless the last frame can be drawn instead; `onReady`
   *   is called when they are compiled. True if memory is lacking, for the last frame that fitted:
   *   the next call throws, once, and later calls retry. An effect whose shader has an error, or whose
   *   texture or buffer the device refuses, is left out: see `onFault`.
   * @throws InvalidArgumentError, GpuLimitError, DestroyedError, ShaderError, CodeUnavailableError.
   */
  prepare(request: EmbeddedFrameRequest): boolean {
    const { frames } = this;
    if (frames.isDestroyed) throw new DestroyedError('This view', 'it was destroyed');
    // The listener is called in a microtask.
    if (!(frames.fault && this.onFault)) frames.throwReceived();
    const hasPixels = frames.check(request);
    if (!hasPixels || request.clouds.length === 0 || frames.context.destroyedBecause() !== null) return false;
    const depths = this.#depthsFor(request);
    const [depth, withOccluders] = depths;
    const { plan, isDrawn, status } = frames.next(request, depths);
    if (!plan) return false;
    if (isDrawn) frames.parts.timer.begin();
    else {
      this.#prepare(plan);
      // Compiles for occluders early, so that they hide these splats from their first frame on.
      if (status === 'ready' && request.depth && !depth?.isTested && this.#precompiled !== plan.shape) {
        const isReady = frames.wait.isReadyOrCompiling({ ...plan.shape, depth: withOccluders! });
        if (isReady) this.#precompiled = plan.shape;
      }
    }
    frames.onDrawn(request);
    return true;
  }

  /**
   * Records drawing the last prepared frame, between two passes of the host. The host submits the
   * work.
   *
   * @throws InvalidArgumentError if nothing was prepared, or if the frame was prepared with depth
   *   and the host has none; GpuLimitError if device limits or the engine's memory budget do not
   *   allow the image; DestroyedError. Nothing is recorded then, and the host can submit its
   *   encoder.
   */
  draw(encoder: GPUCommandEncoder, pass: HostPass): EmbeddedImage {
    given(encoder, { beginRenderPass: 'a function' }, 'encoder');
    this.#shapeOver(pass);
    const { frames } = this;
    // The first draw of a size allocates the image.
    frames.submit(frames.last!, () => {
      frames.parts.record(encoder, frames.drawPasses({ kind: 'host', pass }));
      frames.recordEnd(encoder);
    });
    this.#isDrawn = true;
    // The host submits before it yields to microtasks; reading back must not begin earlier.
    queueMicrotask(() => void frames.measure());
    return frames.parts.host.image!;
  }

  /**
   * Allocates the image that the next `draw` over `pass` fills. For hosts that record its display
   * before they call `draw`.
   *
   * @throws errors of `draw`.
   */
  makeImage(pass: HostPass): EmbeddedImage {
    const shape = this.#shapeOver(pass);
    const { frames } = this;
    frames.submit(frames.last!, () => frames.parts.host.fitImage(shape, pass));
    return frames.parts.host.image!;
  }

  /** Frees the view's GPU memory, after the host has submitted its recording; the clouds stay. */
  destroy(): void {
    if (this.frames.end()) queueMicrotask(() => this.frames.parts.destroy());
  }

  /** Asks the host to prepare the frame again. */
  #askAgain(): void {
    // As a microtask: this may run in the middle of a frame of the host, or of a change of state
    // here.
    queueMicrotask(() => {
      const { frames, onFault } = this;
      if (frames.isDestroyed) return;
      const { fault } = frames;
      if (fault && onFault) {
        frames.fault = null;
        callListener(() => onFault(fault.error, fault.clouds));
      }
      callListener(this.onReady);
    });
  }

  #prepare(plan: FramePlan): Promise<void> {
    const { frames } = this;
    this.#isDrawn = false;
    return frames.submit(plan, () => {
      frames.parts.timer.begin();
      frames.run('websplatter pre-process and sort', (encoder) =>
        frames.parts.record(encoder, frames.orderPasses()),
      );
    });
  }

  /**
   * Returns the shape of the prepared frame. @throws DestroyedError; InvalidArgumentError if it
   * cannot be drawn over `pass`.
   */
  #shapeOver(pass: HostPass): FrameShape {
    this.frames.checkUsable();
    given(
      given(pass, { xPx: 'a number', yPx: 'a number' }, 'pass').color,
      { createView: 'a function' },
      'pass.color',
    );
    const { shape } = this;
    if (!shape) {
      throw new InvalidArgumentError('draw', 'There is nothing to draw yet: prepare must return true first.');
    }
    if (shape.depth?.isTested && !pass.depth) {
      throw new InvalidArgumentError('depth', 'The frame was prepared with depth and the host gave none.');
    }
    return shape;
  }

  /**
   * Returns the requested depth, then the one with occluders, then all others: any of them may be used
   * while shaders compile.
   */
  #depthsFor(request: EmbeddedFrameRequest): PossibleDepths {
    const { camera, depth, hasOccluders = true, writesDepth = false } = request;
    if (!depth) return [null];
    const { mapping, compare } = depth;
    const isOrthographic = camera.projectionMatrix[11] === 0;
    const isBlendable = this.frames.context.device.features.has('float32-blendable' as GPUFeatureName);
    const tested: RasterizeDepth = { mapping, compare, isOrthographic, isTested: true, layerFormat: null };
    const both: RasterizeDepth = { ...tested, layerFormat: isBlendable ? 'r32float' : 'r16float' };
    const written: RasterizeDepth = { ...both, isTested: false };
    const [hiding, free] = writesDepth ? [both, written] : [tested, null];
    return [hasOccluders ? hiding : free, hiding, tested, both, written, null];
  }
}
