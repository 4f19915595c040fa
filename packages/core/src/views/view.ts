import { fetched } from '../data/errors.ts';
import { checkKind, given } from '../data/given.ts';
import { type EffectEntry, effectsLedger } from '../frame/ledger/ledger.ts';
import type { FrameShape } from '../frame/plan/frame-shape.ts';
import type { GpuMemoryReport } from '../gpu/gpu-memory.ts';
import type { FrameStatistics } from '../gpu/timing/frame-statistics.ts';
import type { AccuracyChoice } from '../measure/choose-accuracy.ts';
import type { ChooseAccuracyOptions } from './accuracy-targets.ts';
import type { PointCoverage, PointToCover } from './find-coverage.ts';
import type { SplatPick } from './pick-splat.ts';
import type { RasterizerReport } from './rasterizer-choice.ts';
import type { DetailReport } from './view-detail.ts';
import type { ViewFrames } from './view-frames.ts';

let picking: typeof import('./pick-splat.ts') | null = null;

/** The common interface of all views: reports on the last frame, and searches in it. */
export class View {
  /** Called with the statistics of each measured frame, some frames later; null for no call. */
  onStatistics: ((statistics: FrameStatistics) => void) | null = null;
  /**
   * Called when settings have been chosen for a target (`accuracy: { minPsnrDb: 45 }`). Measuring
   * takes seconds. It begins half a second after the first frame, and after the last change of its
   * size. A scene is measured again when its clouds change, but not when the camera moves. A
   * `SplatView` has already drawn its last frame with the choice; an `EmbeddedView` has called
   * `onReady`, for its host to prepare the frame again. Null for no call.
   */
  onAccuracyChosen: ((choice: AccuracyChoice) => void) | null = null;
  /** @internal */
  protected readonly frames: ViewFrames;

  protected constructor(frames: ViewFrames) {
    this.frames = frames;
    frames.listeners = this;
  }

  /**
   * @internal Whether isotropic splats may use their own shaders; false to measure without them.
   */
  set mayBeIsotropic(mayBeIsotropic: boolean) {
    this.frames.planner.mayBeIsotropic = mayBeIsotropic;
  }

  /** The newest statistics, or null before the first. */
  get statistics(): FrameStatistics | null {
    return this.frames.statistics;
  }

  /** The last choice for the target; null before the first, and if settings were requested. */
  get accuracyChoice(): AccuracyChoice | null {
    return this.frames.accuracy.choice;
  }

  /** Detail of the last frame; null before the first. */
  get detail(): DetailReport | null {
    return this.frames.detail;
  }

  /**
   * Resolves when the last frame has been drawn and its image is final unless something moves. If
   * detail has to be found, the image at rest is drawn again with it first.
   *
   * @throws errors of `whenDrawn`.
   */
  whenComplete(): Promise<void> {
    return this.frames.whenComplete();
  }

  /**
   * Measures the last frame now, and chooses settings that meet its target again. Applies to all
   * views with the same target and clouds, at the size of the largest.
   *
   * @throws InvalidArgumentError if there is no frame yet, or it was drawn without a target;
   *   DestroyedError; an AbortError if the view is destroyed or a later call takes over; the
   *   signal's reason. On failure the settings stay.
   */
  async chooseAccuracy(options: ChooseAccuracyOptions = {}): Promise<AccuracyChoice> {
    this.frames.checkUsable();
    return this.frames.accuracy.choose(given(options));
  }

  /**
   * Returns the splat that contributes most to a pixel of the last image. Objects of other
   * renderers in front of it are ignored. Null if there is no splat, outside the image, and before
   * the first frame.
   *
   * @param xPx, yPx from the top left of the image; a fractional position belongs to the pixel that
   *   contains it.
   * @throws DestroyedError if the view or its engine ends before the result is read.
   */
  async pick(xPx: number, yPx: number): Promise<SplatPick | null> {
    this.frames.checkUsable();
    checkKind('xPx', xPx, 'a number');
    checkKind('yPx', yPx, 'a number');
    // Fetched on demand, because most pages never pick. Later picks search the current frame at
    // once.
    picking ??= await fetched('picking', import('./pick-splat.ts'));
    return picking.pickInView(this.frames, xPx, yPx);
  }

  /**
   * Returns how far splats, and opaque objects of the host's renderer, cover points of the world in
   * the last frame. Takes at most 1,024 points, in one small read-back. Null before the first
   * frame.
   *
   * @throws InvalidArgumentError for too many points and for numbers that are not finite;
   *   GpuLimitError if the device lacks memory; DestroyedError if the view or its engine ends
   *   before the result is read.
   */
  async coverage(points: readonly PointToCover[]): Promise<PointCoverage[] | null> {
    this.frames.checkUsable();
    const { coverageInView } = await fetched('coverage', import('./find-coverage.ts'));
    return coverageInView(this.frames, points);
  }

  /**
   * Lists all effects of the last frame, on and off, with the reason; empty before the first frame.
   * While shaders for other effects compile, the last frame has the old effects.
   */
  effects(): readonly EffectEntry[] {
    const { last: plan, parts, context } = this.frames;
    if (!plan) return [];
    const { memory } = context;
    const { inputs, host, tileLists } = parts;
    const { hostDepth, depthImage, depthLayer } = parts.shared.resources;
    const isTested = plan.shape.depth?.isTested;
    const bytesOf = (each: readonly (GPUBuffer | GPUTexture | null | undefined)[]) =>
      [...new Set(each)].reduce((sum, resource) => sum + memory.bytesOf(resource), 0);
    const held = {
      effects: inputs.effects,
      testedDepthBytes: bytesOf([isTested ? hostDepth : null]) + host.testedDepthBytes,
      writtenDepthBytes: bytesOf([isTested ? null : hostDepth, depthImage, depthLayer, host.image?.depth]),
      tilesBytes: tileLists.bytes,
    };
    return effectsLedger({ plan, held, rasterizer: this.rasterizer });
  }

  /** The rasteriser of this view, and the known times of both. */
  get rasterizer(): RasterizerReport {
    return this.frames.choice.reportOf(this.shape);
  }

  /**
   * @internal Sequence number of the last frame among all frames of the engine; 0 before the first.
   */
  get drawnAs(): number {
    return this.frames.drawnAs;
  }

  /** @internal GPU memory of the view. */
  get memory(): GpuMemoryReport {
    return this.frames.context.memory.report();
  }

  /** Shape of the last frame: its clouds, their effects and its passes; null before the first. */
  get shape(): FrameShape | null {
    return this.frames.parts.shape;
  }
}
