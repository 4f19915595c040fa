import { hasSameFields } from '../../data/has-same-fields.ts';
import type { CloudSight } from './cloud-sight.ts';
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
const LEAST_REDRAW_MS = 8;

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
  readonly #paces = { moving: new PartPace(PACES.moving), still: new PartPace(PACES.still) };
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
    return { parts: Number.POSITIVE_INFINITY, ms: Math.max(LEAST_REDRAW_MS, this.#redrawMs) };
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

/**
 * A frame that begins later than this after the previous one, in milliseconds, starts a new motion.
 */
const LONGEST_PAUSE_MS = 500;
/**
 * A view is at rest after this many times the last pause without a frame, and after at least
 * LEAST_REST_MS.
 */
const REST_PAUSES = 2;
const LEAST_REST_MS = 50;

/**
 * Frames that a view draws on its own, not because streamed parts have changed. Pauses are measured
 * from the end of a frame on the device to the next beginning, so that slow devices count as moving
 * too.
 */
export class OwnFrames {
  #beginMs = Number.NEGATIVE_INFINITY;
  #endMs = Number.NEGATIVE_INFINITY;
  #underWay = 0;
  #stepMs = Number.POSITIVE_INFINITY;
  #pauseMs = Number.POSITIVE_INFINITY;

  /** Milliseconds between the beginnings of the last two frames. */
  get stepMs(): number {
    return this.#stepMs;
  }

  begin(nowMs: number): void {
    this.#stepMs = nowMs - this.#beginMs;
    this.#pauseMs = this.#underWay > 0 ? 0 : nowMs - this.#endMs;
    this.#beginMs = nowMs;
    this.#underWay++;
  }

  /** Call if the last frame is submitted in parts; `end` must then be called once more. */
  prolong(): void {
    this.#underWay++;
  }

  /** Call when the device has finished a frame. */
  end(nowMs: number): void {
    this.#underWay--;
    this.#endMs = nowMs;
  }

  /** Milliseconds for which another frame is still expected; 0 if none is. */
  restMs(nowMs: number): number {
    if (this.#pauseMs > LONGEST_PAUSE_MS) return 0;
    const restMs = Math.max(LEAST_REST_MS, REST_PAUSES * this.#pauseMs);
    return this.#underWay > 0 ? restMs : Math.max(0, this.#endMs + restMs - nowMs);
  }
}

/** Weight of a new frame in the running mean of frame times. */
const MEAN_WEIGHT = 1 / 4;
/** Most frames in time before the limit is raised again. */
const MOST_PATIENCE = 32;
/** Least time that placing parts may take on the thread between two frames, ms. */
const LEAST_MS = 1;

/** How quickly parts may come while a view draws on its own. */
interface Pace {
  /** Share of the interval between frames by which placing parts may delay a frame. */
  readonly delayShare: number;
  /** Most time that placing parts may take on the thread between two frames. */
  readonly mostMs: number;
  /** Limit once the time of a frame after at most one part is known. */
  readonly firstParts: number;
  /** By how much a limit grows. */
  readonly growthOf: (parts: number) => number;
}

export const PACES = {
  /** A late frame would be seen. */
  moving: { delayShare: 1 / 4, mostMs: 4, firstParts: 1, growthOf: () => 1 },
  /** The view draws the same again and again: parts shall come soon. */
  still: { delayShare: 1, mostMs: 8, firstParts: 8, growthOf: (parts) => parts },
} as const satisfies Record<string, Pace>;

/** Limit of the parts to place or remove now; one part is always allowed. */
export interface PartLimit {
  readonly parts: number;
  /** Time on the thread. */
  readonly ms: number;
}

/**
 * Limits how many parts of a scene are placed or removed between two frames of a view that draws on
 * its own. The limit grows after frames that reached it in time, and halves after a late one. After
 * each late frame, twice as many must be in time before it grows.
 */
export class PartPace {
  readonly #pace: Pace;
  #parts: number;
  #ms: number;
  /** Time of a frame after at most one part, ms; undefined before the first. */
  #plainMs: number | undefined;
  #patience = 1;
  #inTime = 0;

  constructor(pace: Pace) {
    this.#pace = pace;
    this.#ms = pace.mostMs;
    this.#parts = pace.firstParts;
  }

  get limit(): PartLimit {
    return { parts: this.#plainMs === undefined ? 1 : this.#parts, ms: this.#ms };
  }

  /**
   * Updates the limit after a frame.
   *
   * @param parts parts placed or removed since the previous frame.
   * @param frameMs from the frame's beginning until the device has finished it.
   * @param stepMs between the beginnings of the previous frame and this one.
   */
  addFrame(parts: number, frameMs: number, stepMs: number): void {
    const plainMs = this.#plainMs ?? frameMs;
    const delayMs = this.#pace.delayShare * stepMs;
    this.#ms = Math.max(LEAST_MS, Math.min(this.#pace.mostMs, delayMs));
    if (parts <= 1) this.#plainMs = plainMs + MEAN_WEIGHT * (frameMs - plainMs);
    if (parts === 0) this.#patience = 1;
    else if (frameMs > plainMs + delayMs) this.#slowDown(parts);
    else if (parts >= this.#parts && ++this.#inTime >= this.#patience) {
      this.#parts += this.#pace.growthOf(this.#parts);
      this.#inTime = 0;
    }
  }

  #slowDown(parts: number): void {
    this.#parts = Math.max(1, Math.floor(Math.min(parts, this.#parts) / 2));
    this.#patience = Math.min(MOST_PATIENCE, 2 * this.#patience);
    this.#inTime = 0;
  }
}
