import {
  type AccuracySettings,
  type FrameRasterizer,
  layerSize,
  type SizePx,
} from '../../data/accuracy/accuracy.ts';
import { type Camera, projectionOf } from '../../data/camera/camera.ts';
import { hasSameFields } from '../../data/has-same-fields.ts';
import { binGrid } from '../../data/layout/bin-grid.ts';
import { asksForDistance } from '../../data/splats/sort-by.ts';
import type { EffectFaults } from '../../gpu/effects/cloud-effects.ts';
import type { RasterizeDepth } from '../../stages/quads/quads.ts';
import { cloudShape, planCloud } from './cloud-plan.ts';
import { type FixedDetail, isFixedDetail } from './detail.ts';
import { type FrameNeeds, type FramePlan, showsClouds } from './frame-plan.ts';
import type { FrameRequest } from './frame-request.ts';
import { type FrameOutput, type FrameShape, hasWideKeys, isSameShape } from './frame-shape.ts';
import { keyBitsFor, wideKeysFor } from './key-bits.ts';
import { cutBudget, neededDetail } from './level-cut.ts';
import { isSameColors, isSameOrder } from './plan-difference.ts';
import { RecentPeak } from './recent-peak.ts';
import { mostDrawnSplats, mostVisibleSplats, visibleCapacity } from './visible-capacity.ts';

/** Constants of a view that its plans depend on. */
export interface PlannerContext extends Pick<FrameShape, 'dispatchRow' | 'sortDevice'> {
  /** Default: none. */
  readonly faults?: EffectFaults;
}

/** Decisions about a frame besides its request. */
export interface FrameSettings {
  /** Equal settings are the same object. */
  readonly accuracy: AccuracySettings;
  /** The part that `movingScale` of the plan has in the resolution of `accuracy`. Default: 1. */
  readonly movingScale?: number;
  readonly depth: RasterizeDepth | null;
  /** The rasteriser for the setting `auto`. */
  readonly faster: FrameRasterizer;
  /** Default: the detail of the request; `full` if the request asks for an outcome. */
  readonly detail?: FixedDetail;
  /** Overrides the sizes that follow from the request, to inspect single stages. */
  readonly sizes?: Pick<FrameShape, 'visibleCapacity' | 'keyBits' | 'shortensKeys'>;
}

/** Plans the frames of one view, each once: by its request, settings and earlier frames. */
export class FramePlanner {
  /** Whether round splats may have shaders of their own; false to measure without them. */
  mayBeIsotropic = true;
  readonly #context: PlannerContext;
  readonly #output: FrameOutput;
  readonly #isReady: (shape: FrameShape) => boolean;
  #last: FramePlan | null = null;
  /** Whether the device has refused the last frame, so that its buffers have nothing of it. */
  #isLastRefused = false;
  #needs = new RecentNeeds();

  /**
   * @param isReady whether a shape's shaders are compiled. Until the shape that `auto` chooses is ready,
   *   frames keep the last frame's rasteriser.
   */
  constructor(context: PlannerContext, output: FrameOutput, isReady: (shape: FrameShape) => boolean) {
    this.#context = context;
    this.#output = output;
    this.#isReady = isReady;
  }

  /** Plan of the last frame; null before the first. */
  get last(): FramePlan | null {
    return this.#last;
  }

  /**
   * Plans a frame. It keeps the last frame's shape object if nothing in it changes. Buffers keep their
   * size while it suffices or was needed recently.
   *
   * @throws InvalidArgumentError naming the cloud, if its effects cannot be combined; errors of
   *   callers' own effects.
   */
  plan(request: FrameRequest, settings: FrameSettings): FramePlan {
    const { accuracy, movingScale = 1, depth, faster, sizes } = settings;
    const { dispatchRow, sortDevice, faults } = this.#context;
    const last = this.#last;
    const camera = copied(request.camera);
    const layer = layerSize(request, accuracy);
    const projection = projectionOf(camera, layer.widthPx, layer.heightPx);
    const { isOrthographic } = projection;
    const sortsByDistance = !isOrthographic && asksForDistance(request);
    const { detail: requested = 'full', fade = 1 } = request;
    const given = settings.detail ?? (isFixedDetail(requested) ? requested : 'full');
    const detail = neededDetail(given, request.clouds);
    const clouds = request.clouds.map((instance) =>
      planCloud(instance, camera, projection, accuracy, detail, faults),
    );
    const budget = cutBudget(detail, clouds);
    const isWide = hasWideKeys({ keyBits: sizes?.keyBits ?? accuracy.sortKeyBits });
    const wide = isWide ? wideKeysFor(camera, clouds, sortsByDistance) : null;
    const needs = {
      visibleSplats: mostVisibleSplats(clouds, budget),
      depthBits: wide?.bits ?? keyBitsFor(camera, clouds, sortsByDistance),
    };
    const isSameScene = last !== null && showsClouds(last, request.clouds);
    const recent = isSameScene ? this.#needs.value : { visibleSplats: 0, depthBits: 0 };
    const capacity = visibleCapacity(
      needs.visibleSplats,
      mostDrawnSplats(clouds, budget),
      isSameScene ? last.shape.visibleCapacity : 0,
      recent.visibleSplats,
    );
    const shapes = clouds.map((cloud) => cloudShape(cloud, accuracy, this.mayBeIsotropic));
    // Excess bits take a pass more and sort the same; other buffers and shaders take longer.
    const keyBits = Math.min(
      // Needs of the other kind of keys say nothing.
      Math.max(
        needs.depthBits,
        hasWideKeys({ keyBits: recent.depthBits }) === (wide !== null) ? recent.depthBits : 0,
      ),
      accuracy.sortKeyBits,
    );
    const shapeBy = (asked: FrameRasterizer): FrameShape => {
      // Compute shaders cannot write r16float, the only depth to blend without float32-blendable.
      const rasterizer = depth?.layerFormat === 'r16float' ? 'quads' : asked;
      const shape = {
        clouds: shapes,
        isOrthographic,
        sortsByDistance,
        isStacked: shapes.some(({ levels }) => levels !== null),
        isBudgeted: budget !== null,
        accuracy,
        dispatchRow,
        sortDevice,
        visibleCapacity: sizes?.visibleCapacity ?? capacity,
        keyBits: sizes?.keyBits ?? keyBits,
        shortensKeys: sizes?.shortensKeys ?? accuracy.sortKeyBits < needs.depthBits,
        depth,
        isFaded: fade !== 1,
        output: this.#output,
        rasterizer,
        binCount: rasterizer === 'tiles' ? binCountOf(layer) : 0,
      };
      return last && isSameShape(last.shape, shape) ? last.shape : shape;
    };
    const asked = shapeBy(accuracy.rasterizer === 'auto' ? faster : accuracy.rasterizer);
    const isSame =
      last !== null &&
      !request.force &&
      !this.#isLastRefused &&
      isSameOrder(last, { request, camera, clouds, budget, shape: asked });
    const isDrawn =
      isSame &&
      hasSameFields(last.shape.depth, depth) &&
      isSameColors(last.clouds, clouds) &&
      (last.request.fade ?? 1) === fade;
    const mayStay = last !== null && accuracy.rasterizer === 'auto' && !isDrawn;
    const isOther = mayStay && last.shape.rasterizer !== asked.rasterizer;
    const shape = isOther && !this.#isReady(asked) ? shapeBy(last.shape.rasterizer) : asked;
    return {
      request: { ...request, clouds: clouds.map(({ instance }) => instance) },
      camera,
      layer,
      projection,
      clouds,
      detail,
      movingScale,
      budget,
      needs,
      farthestHigh: wide?.farthestHigh ?? 0,
      shape,
      isDrawn,
      // The other rasteriser has not filled its buffers.
      keepsOrder: isSame && last.shape.rasterizer === shape.rasterizer,
    };
  }

  /**
   * Plans the same frame with the settings and effects of the last one, so that the view keeps
   * moving while shaders compile. Null if there is no last frame, or if it had other clouds. The
   * last frame itself if it had previews.
   *
   * @param depths range of depths that the last frame may have had.
   */
  planStopgap({ request, shape }: FramePlan, depths: readonly (RasterizeDepth | null)[]): FramePlan | null {
    const last = this.#last;
    if (!last || last.clouds.length !== request.clouds.length) return null;
    const { accuracy, depth, rasterizer } = last.shape;
    if (!depths.some((possible) => hasSameFields(possible, depth))) return null;
    // Nothing new can be drawn of a preview that has been replaced, but its image is there.
    if (!showsClouds(last, request.clouds))
      return last.shape.clouds.some(({ cloud }) => cloud.isPreview) ? last : null;
    const clouds = request.clouds.map((instance, i) => {
      const { opacity, effects, shDegree, instances } = last.clouds[i].instance;
      const { effects: drawn, instanceCount } = last.shape.clouds[i];
      const isInstanced = shape.clouds[i].instanceCount !== null;
      if (shape.clouds[i].effects === drawn && isInstanced === (instanceCount !== null))
        return { ...instance, shDegree };
      // A new selection may have turned an effect on since the last frame.
      const before = effects?.filter(
        ({ effect, reason }) => reason === null || drawn.linked.some((each) => each.effect === effect),
      );
      return { ...instance, shDegree, opacity, effects: before, instances };
    });
    const { detail, movingScale } = last;
    const { sortBy, fade } = last.request;
    return this.plan(
      { ...request, clouds, sortBy, fade, force: false },
      { accuracy, movingScale, depth, faster: rasterizer, detail },
    );
  }

  /** Takes a frame for which there is room, and which is about to be drawn, at `nowMs`. */
  take(plan: FramePlan, nowMs: number): void {
    if (this.#last && !showsClouds(this.#last, plan.request.clouds)) this.#needs = new RecentNeeds();
    this.#needs.take(plan.needs, nowMs);
    this.#last = plan;
    this.#isLastRefused = false;
  }

  /** The device has refused `plan`: if it was the last frame, the next draws all of it again. */
  refuse({ clouds }: FramePlan): void {
    this.#isLastRefused ||= clouds === this.#last?.clouds;
  }

  /** Takes a plan that is drawn already: its request may say the same in other words. */
  keep({ request, detail, movingScale }: FramePlan): void {
    // The plan's shape may belong to the other rasteriser, which has drawn nothing.
    if (this.#last) this.#last = { ...this.#last, request, detail, movingScale };
  }

  /** Forgets the frames before, whose buffers are gone. */
  forget(): void {
    this.#last = null;
    this.#needs = new RecentNeeds();
  }
}

function binCountOf({ widthPx, heightPx }: SizePx): number {
  const { binColumns, binRows } = binGrid(widthPx, heightPx);
  return binColumns * binRows;
}

function copied(camera: Camera): Camera {
  return {
    ...camera,
    viewMatrix: new Float64Array(camera.viewMatrix),
    projectionMatrix: new Float64Array(camera.projectionMatrix),
    wholeProjectionMatrix: camera.wholeProjectionMatrix && new Float64Array(camera.wholeProjectionMatrix),
  };
}

/** Wide keys cost a pass more; other widths need other buffers and bindings, which take longer. */
const KEYS_PERIOD_MS = 30_000;

/** Needs of a view's recent frames, as long as they show the same clouds. */
export class RecentNeeds {
  readonly #visibleSplats = new RecentPeak();
  /** Powers of two, so that a need of fewer bits is less than half. */
  readonly #depths = new RecentPeak(KEYS_PERIOD_MS);

  /** The largest needs of recent frames; of nothing before the first. */
  get value(): FrameNeeds {
    return { visibleSplats: this.#visibleSplats.value, depthBits: Math.log2(this.#depths.value) };
  }

  /** Takes the needs of a frame that was drawn at `atMs`. */
  take({ visibleSplats, depthBits }: FrameNeeds, atMs: number): void {
    this.#visibleSplats.take(visibleSplats, atMs);
    this.#depths.take(2 ** depthBits, atMs);
  }
}
