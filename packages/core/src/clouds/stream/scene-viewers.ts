import { hasSameFields } from '../../data/has-same-fields.ts';
import type { CloudSight } from './cloud-sight.ts';
import { OwnFrames, type PartLimit, PartPace } from './part-pace.ts';
import { isSameView, SightPrediction } from './sight-prediction.ts';

/** The sights that a scene is streamed for. */
export interface Sights {
  /** The sights of all views; the same array until they change. */
  readonly sights: readonly CloudSight[];
  /** Extrapolated sights of moving views; the same array until they change. */
  readonly predicted: readonly CloudSight[];
  /** Whether there are views and all of their sights are current. */
  readonly areCurrent: boolean;
}

/**
 * Least time for placing parts between two redraws of views at rest, ms. It is longer where a redraw
 * takes longer, so that redraws take half of the time at most.
 */
const LEAST_REST_MS = 8;

/** The same array each time, so that plans without predicted sights are not made again. */
const NONE_PREDICTED: readonly CloudSight[] = [];

interface Viewer {
  sights: readonly CloudSight[];
  /** Whether `sights` belong to the view's last frame. */
  isCurrent: boolean;
  redraw: () => Promise<unknown>;
  readonly ownFrames: OwnFrames;
  readonly prediction: SightPrediction;
  /** Whether the stream itself has requested the view's next frame. */
  isRequested: boolean;
  /**
   * Whether parts have changed since the view's last frame, and its own next frame will draw the
   * change.
   */
  isBehind: boolean;
}

/**
 * The views that draw one streamed scene: their sights, their motion, and their frames. A view that
 * draws frame after frame on its own draws changes with its next frame; other views are redrawn.
 */
export class SceneViewers implements Sights {
  readonly #viewers = new Map<object, Viewer>();
  readonly #whenDone: () => Promise<unknown>;
  readonly #onChange: () => void;
  #sights: readonly CloudSight[] | null = null;
  #predicted: readonly CloudSight[] | null = null;
  /** Views that are being redrawn, and views that must then be redrawn once more. */
  readonly #drawing = new Set<object>();
  readonly #stale = new Set<object>();
  readonly #paces = { moving: PartPace.moving(), still: PartPace.still() };
  /** Time of the last redraw. */
  #redrawMs = 0;
  /** Parts placed or removed since the last frame. */
  #newParts = 0;
  /** Runs until moving views may be at rest. */
  #restTimer: ReturnType<typeof setTimeout> | null = null;

  /**
   * @param whenDone resolves when the device has finished all submitted work.
   * @param onChange called when sights have changed, views have come to rest or have been redrawn.
   */
  constructor(whenDone: () => Promise<unknown>, onChange: () => void) {
    this.#whenDone = whenDone;
    this.#onChange = onChange;
  }

  /** Call when a view is about to draw a frame. `sights` is null while they are unknown. */
  set(view: object, sights: readonly CloudSight[] | null, redraw: () => Promise<unknown>): void {
    let viewer = this.#viewers.get(view);
    if (!viewer) {
      viewer = {
        sights: [],
        isCurrent: false,
        redraw,
        ownFrames: new OwnFrames(),
        prediction: new SightPrediction(),
        isRequested: false,
        isBehind: false,
      };
      this.#viewers.set(view, viewer);
    }
    if (!viewer.isRequested) this.#timeFrame(viewer.ownFrames);
    viewer.isRequested = false;
    viewer.isBehind = false;
    viewer.redraw = redraw;
    if (sights) viewer.prediction.take(sights, performance.now());
    this.#storeSights(viewer, sights);
    if (this.predicted.length > 0) this.awaitRest();
  }

  /** Replaces the sights of the last `set`, without a new frame. */
  update(view: object, sights: readonly CloudSight[]): void {
    const viewer = this.#viewers.get(view);
    if (viewer) this.#storeSights(viewer, sights);
  }

  #storeSights(viewer: Viewer, sights: readonly CloudSight[] | null): void {
    viewer.isCurrent = sights !== null;
    if (sights && !isSameSights(viewer.sights, sights)) {
      viewer.sights = sights;
      this.#sights = null;
    }
    if (sights) this.#predicted = null;
    this.#onChange();
  }

  /** Removes a view; returns whether it was there. */
  remove(view: object): boolean {
    this.#stale.delete(view);
    this.#sights = null;
    this.#predicted = null;
    return this.#viewers.delete(view);
  }

  /** Removes all views. */
  end(): void {
    if (this.#restTimer !== null) clearTimeout(this.#restTimer);
    this.#viewers.clear();
  }

  /** The sights of one view; empty if the view does not draw the scene. */
  sightsOf(view: object): readonly CloudSight[] {
    return this.#viewers.get(view)?.sights ?? [];
  }

  get sights(): readonly CloudSight[] {
    this.#sights ??= [...this.#viewers.values()].flatMap(({ sights }) => sights);
    return this.#sights;
  }

  get predicted(): readonly CloudSight[] {
    if (this.#predicted === null) {
      const predicted = this.#viewersInMotion.flatMap(({ prediction }) => prediction.predict());
      this.#predicted = predicted.length > 0 ? predicted : NONE_PREDICTED;
    }
    return this.#predicted;
  }

  get areCurrent(): boolean {
    return this.#viewers.size > 0 && [...this.#viewers.values()].every(({ isCurrent }) => isCurrent);
  }

  /** Whether any view draws frame after frame on its own. */
  get areMoving(): boolean {
    return this.#viewersInMotion.length > 0;
  }

  get #viewersInMotion(): readonly Viewer[] {
    const nowMs = performance.now();
    return [...this.#viewers.values()].filter(({ ownFrames }) => ownFrames.restMs(nowMs) > 0);
  }

  /** Whether a view is being redrawn. */
  get areRedrawing(): boolean {
    return this.#drawing.size > 0;
  }

  /** Whether all views have drawn the last change. */
  get areUpToDate(): boolean {
    return this.#stale.size === 0 && !this.#isBehind;
  }

  /** Whether a moving view has not yet drawn the last change. */
  get #isBehind(): boolean {
    return [...this.#viewers.values()].some(({ isBehind }) => isBehind);
  }

  /** Limit of the parts to place or remove now. */
  get limit(): PartLimit {
    if (this.areMoving) return this.#pace.limit;
    return { parts: Number.POSITIVE_INFINITY, ms: Math.max(LEAST_REST_MS, this.#redrawMs) };
  }

  /** The pace of views that draw on their own. */
  get #pace(): PartPace {
    const isMoving = this.#viewersInMotion.some(({ prediction }) => prediction.isMoving);
    return isMoving ? this.#paces.moving : this.#paces.still;
  }

  /** Times a frame that is about to be submitted. */
  #timeFrame(ownFrames: OwnFrames): void {
    const beginMs = performance.now();
    ownFrames.begin(beginMs);
    const { stepMs } = ownFrames;
    const newParts = this.#newParts;
    this.#newParts = 0;
    const pace = this.#pace;
    const end = () => {
      const endMs = performance.now();
      ownFrames.end(endMs);
      // Without a predecessor, a frame's time does not predict others.
      if (Number.isFinite(stepMs)) pace.addFrame(newParts, endMs - beginMs, stepMs);
    };
    queueMicrotask(() => this.#whenDone().then(end, end));
  }

  /** Counts all current frames as under way until the returned function is called. */
  prolongFrames(): () => void {
    const frames = [...this.#viewers.values()].map(({ ownFrames }) => ownFrames);
    for (const each of frames) each.prolong();
    return () => {
      for (const each of frames) each.end(performance.now());
    };
  }

  /**
   * Makes all views draw a change: moving views with their own next frame, others at once.
   *
   * @param newParts number of parts placed or removed.
   */
  redraw(newParts = 0): void {
    this.#newParts += newParts;
    const nowMs = performance.now();
    for (const [view, viewer] of this.#viewers) {
      if (viewer.ownFrames.restMs(nowMs) > 0) viewer.isBehind = true;
      else void this.#redraw(view, viewer);
    }
    if (this.#isBehind) this.awaitRest();
    this.#onChange();
  }

  /** Redraws a view, and once more if parts have changed meanwhile. */
  async #redraw(view: object, viewer: Viewer): Promise<void> {
    viewer.isBehind = false;
    this.#stale.add(view);
    if (this.#drawing.has(view)) return;
    this.#drawing.add(view);
    while (this.#stale.delete(view)) {
      viewer.isRequested = true;
      const beganMs = performance.now();
      // The view itself reports errors.
      await viewer.redraw().catch(() => {});
      this.#redrawMs = performance.now() - beganMs;
    }
    this.#drawing.delete(view);
    this.#onChange();
  }

  /** Calls `onChange` once views have come to rest, and redraws views that are behind. */
  awaitRest(): void {
    if (this.#restTimer !== null) return;
    const nowMs = performance.now();
    const restMs = this.#viewersInMotion.reduce(
      (most, { ownFrames }) => Math.max(most, ownFrames.restMs(nowMs)),
      0,
    );
    // The timer runs even if views have just come to rest, because waiting parts depend on it
    // alone.
    this.#restTimer = setTimeout(() => {
      this.#restTimer = null;
      const nowMs = performance.now();
      for (const [view, viewer] of this.#viewers) {
        if (viewer.ownFrames.restMs(nowMs) > 0) continue;
        viewer.prediction.stop();
        if (viewer.isBehind) void this.#redraw(view, viewer);
      }
      this.#predicted = null;
      if (this.#isBehind || this.predicted.length > 0) this.awaitRest();
      this.#onChange();
    }, Math.ceil(restMs));
  }
}

/** Whether plans for both are the same. */
function isSameSights(a: readonly CloudSight[], b: readonly CloudSight[]): boolean {
  return (
    a.length === b.length &&
    a.every(
      (sight, i) =>
        isSameView(sight, b[i]) &&
        sight.squaredShift === b[i].squaredShift &&
        isSameThreshold(sight.cut, b[i].cut) &&
        hasSameFields(sight.budget ?? null, b[i].budget ?? null),
    )
  );
}

/** Whether two cuts allow the same error at each distance. */
function isSameThreshold(a: CloudSight['cut'], b: CloudSight['cut']): boolean {
  return (
    a.squaredPerDistance === b.squaredPerDistance &&
    a.leastSquared === b.leastSquared &&
    a.margin === b.margin
  );
}
