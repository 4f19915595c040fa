import { SplatSourceError } from '../../data/errors.ts';
import { hasSameFields } from '../../data/has-same-fields.ts';
import { Listeners } from '../../data/listeners.ts';
import { nextTask } from '../../data/turns.ts';
import type { CloudSight } from './cloud-sight.ts';
import type { CloudStream, StreamReport } from './cloud-stream.ts';
import type { CoarseSplats } from './coarse-splats.ts';
import { OwnFrames } from './own-frames.ts';
import { SightMotion } from './sight-motion.ts';

/** Share of the interval between frames by which placing parts may delay a frame. */
const DELAY_SHARE = 1 / 4;
/** Weight of a new frame in the running mean of frame times. */
const MEAN_WEIGHT = 1 / 4;
/** Most frames in time before the limit is raised again. */
const MOST_PATIENCE = 32;

/**
 * Limits how many parts of a scene are placed or removed between two frames of a moving view. The
 * limit grows by one after frames that reached it in time, and halves after a late one. After each
 * late frame, twice as many must be in time before it grows.
 */
export class PartPace {
  #most = 1;
  /** Time of a frame after at most one part, ms; undefined before the first. */
  #plainMs: number | undefined;
  #patience = 1;
  #inTime = 0;

  /** Most parts to place or remove after a frame, at least 1. */
  get most(): number {
    return this.#most;
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
    if (parts <= 1) this.#plainMs = plainMs + MEAN_WEIGHT * (frameMs - plainMs);
    if (parts === 0) this.#patience = 1;
    else if (frameMs > plainMs + DELAY_SHARE * stepMs) this.#slowDown(parts);
    else if (parts >= this.#most && ++this.#inTime >= this.#patience) {
      this.#most++;
      this.#inTime = 0;
    }
  }

  #slowDown(parts: number): void {
    this.#most = Math.max(1, Math.floor(Math.min(parts, this.#most) / 2));
    this.#patience = Math.min(MOST_PATIENCE, 2 * this.#patience);
    this.#inTime = 0;
  }
}

/** Window over which bytes per second are counted, ms. */
const WINDOW_MS = 2000;

/** Bytes per second over the last two seconds, or since fetching began if that is later. */
class FetchRate {
  /** Arrivals within the window, oldest first. */
  #arrivals: readonly { readonly atMs: number; readonly bytes: number }[] = [];
  #beganMs = 0;

  /** Call when a fetch begins while no other runs. */
  begin(): void {
    this.#beganMs = performance.now();
  }

  take(bytes: number): void {
    const atMs = performance.now();
    const recent = this.#arrivals.filter((each) => each.atMs > atMs - WINDOW_MS);
    this.#arrivals = [...recent, { atMs, bytes }];
  }

  get bytesPerSecond(): number {
    const nowMs = performance.now();
    const sinceMs = Math.max(this.#beganMs, nowMs - WINDOW_MS);
    const bytes = this.#arrivals.reduce((sum, each) => sum + (each.atMs >= sinceMs ? each.bytes : 0), 0);
    return nowMs > sinceMs ? (1000 * bytes) / (nowMs - sinceMs) : 0;
  }
}

interface Viewer {
  sights: readonly CloudSight[];
  /** Whether `sights` belong to the view's last frame. */
  isCurrent: boolean;
  redraw: () => Promise<unknown>;
  readonly ownFrames: OwnFrames;
  readonly motion: SightMotion;
  /** Whether the stream itself has requested the view's next frame. */
  isRequested: boolean;
  /**
   * Whether parts have changed since the view's last frame, and its own next frame will draw the
   * change.
   */
  isBehind: boolean;
}

/**
 * Base of all streams: tracks the sights of views, redraws views, and notifies listeners. Fetched
 * parts wait to be applied, because the GPU's contents must change between frames only. While a
 * view draws frame after frame on its own, a few parts are applied after each frame, and its next
 * frame draws them. At rest, all are applied at once, and views are redrawn.
 */
export abstract class ViewedStream implements CloudStream {
  readonly #viewers = new Map<object, Viewer>();
  #sights: readonly CloudSight[] | null = null;
  #predicted: readonly CloudSight[] | null = null;
  readonly #listeners = new Listeners();
  #isNotifyDue = false;
  /** The report at the last notification of listeners, or when the first subscribed. */
  #reported: StreamReport | null = null;
  /** Views that are being redrawn, and views that must then be redrawn once more. */
  readonly #drawing = new Set<object>();
  readonly #stale = new Set<object>();
  /** Parts must not be applied until these settle. */
  readonly #holds = new Set<Promise<unknown>>();
  readonly #onOnline = () => {
    if (this.error instanceof SplatSourceError) this.retry();
  };
  #isApplyDue = false;
  #isUpdateDue = false;
  #hasFrame = false;
  readonly #pace = new PartPace();
  /** Parts placed or removed since the last frame. */
  #newParts = 0;
  /** Runs until moving views may be at rest. */
  #restTimer: ReturnType<typeof setTimeout> | null = null;
  /** Pending while parts that fit are missing, waiting or not yet drawn; else null. */
  #wait: { readonly complete: Promise<void>; readonly end: () => void } | null = null;
  protected readonly rate = new FetchRate();
  /** Error of the last fetch; while it is set, nothing is fetched. */
  protected error: Error | null = null;
  protected isEnded = false;
  /** Whether a first picture of the scene has been drawn. */
  protected isPictured = false;

  constructor() {
    // The event exists on pages and in workers only.
    globalThis.addEventListener?.('online', this.#onOnline);
  }

  abstract report(): StreamReport;

  abstract missingFor(view: object): number;
  abstract lackingCells(): Set<number>;
  abstract coarse(signal?: AbortSignal): Promise<CoarseSplats>;

  /** Called when sights change, parts may be applied again, or fetching resumes. */
  protected abstract update(): void;

  /**
   * Schedules one `update` for all changes of this task. As a microtask, so that frames are
   * submitted first and the device draws meanwhile.
   */
  protected updateSoon(): void {
    if (this.#isUpdateDue) return;
    this.#isUpdateDue = true;
    queueMicrotask(() => this.flushUpdate());
  }

  /** Runs a scheduled `update` now, so that results are current. */
  protected flushUpdate(): void {
    if (!this.#isUpdateDue) return;
    this.#isUpdateDue = false;
    this.update();
  }

  /** Resolves when the device has finished all submitted work. */
  protected abstract whenDone(): Promise<unknown>;

  /** Whether parts wait to be placed or removed. */
  protected abstract get isWaiting(): boolean;

  /**
   * Places or removes up to `mostParts` waiting parts; each keeps the device busy for a while.
   * Returns the number of parts, 0 if frames do not change.
   */
  protected abstract applyPending(mostParts: number): number;

  get complete(): Promise<void> | null {
    this.flushUpdate();
    return this.#wait?.complete ?? null;
  }

  setSights(view: object, sights: readonly CloudSight[] | null, redraw: () => Promise<unknown>): void {
    let viewer = this.#viewers.get(view);
    if (!viewer) {
      viewer = {
        sights: [],
        isCurrent: false,
        redraw,
        ownFrames: new OwnFrames(),
        motion: new SightMotion(),
        isRequested: false,
        isBehind: false,
      };
      this.#viewers.set(view, viewer);
    }
    if (!viewer.isRequested) this.#timeFrame(viewer.ownFrames);
    viewer.isRequested = false;
    viewer.isBehind = false;
    viewer.redraw = redraw;
    if (sights) viewer.motion.take(sights, performance.now());
    this.#storeSights(viewer, sights);
    if (this.predicted.length > 0) this.#awaitRest();
    this.#scheduleApply(true);
  }

  /** Times a frame that is about to be submitted. */
  #timeFrame(ownFrames: OwnFrames): void {
    const beginMs = performance.now();
    ownFrames.begin(beginMs);
    const { stepMs } = ownFrames;
    const newParts = this.#newParts;
    this.#newParts = 0;
    const end = () => {
      const endMs = performance.now();
      ownFrames.end(endMs);
      // Without a predecessor, a frame's time does not predict others.
      if (Number.isFinite(stepMs)) this.#pace.addFrame(newParts, endMs - beginMs, stepMs);
    };
    queueMicrotask(() => this.whenDone().then(end, end));
  }

  onFrame(): void {
    if (this.#hasFrame) return;
    this.#hasFrame = true;
    const begin = () => {
      this.isPictured = true;
      this.updateSoon();
    };
    // Hosts submit the frame before they yield.
    queueMicrotask(() => this.whenDone().then(begin, begin));
  }

  updateSights(view: object, sights: readonly CloudSight[]): void {
    const viewer = this.#viewers.get(view);
    if (viewer) this.#storeSights(viewer, sights);
  }

  #storeSights(viewer: Viewer, sights: readonly CloudSight[] | null): void {
    viewer.isCurrent = sights !== null;
    if (sights) {
      viewer.sights = sights;
      this.#sights = null;
      this.#predicted = null;
    }
    this.updateSoon();
  }

  subscribe(listener: () => void): () => void {
    // Changes before the first subscription are not reported.
    if (this.#listeners.size === 0) this.#reported = this.report();
    return this.#listeners.add(listener);
  }

  /**
   * Notifies listeners if the report has changed, in a task of its own. So a listener that retries
   * or draws cannot recurse, and other tasks run in between.
   */
  async #notifySoon(): Promise<void> {
    if (this.#isNotifyDue || this.#listeners.size === 0) return;
    this.#isNotifyDue = true;
    await nextTask();
    this.#isNotifyDue = false;
    const report = this.report();
    const isNew = !this.#reported || !hasSameFields(this.#reported, report);
    this.#reported = report;
    if (isNew) this.#listeners.call();
    if (this.isEnded) this.#listeners.clear();
  }

  leave(view: object): void {
    this.#stale.delete(view);
    this.#sights = null;
    this.#predicted = null;
    if (this.#viewers.delete(view)) this.update();
  }

  hold(until: Promise<unknown>): void {
    this.#holds.add(until);
    const frames = [...this.#viewers.values()].map(({ ownFrames }) => ownFrames);
    for (const each of frames) each.prolong();
    const release = () => {
      this.#holds.delete(until);
      for (const each of frames) each.end(performance.now());
      this.updateSoon();
    };
    until.then(release, release);
  }

  retry(): void {
    if (this.isEnded || this.error === null) return;
    this.error = null;
    // If it fails again with the same error, listeners are notified again.
    this.#reported = null;
    this.updateSoon();
  }

  end(): void {
    this.isEnded = true;
    if (this.#restTimer !== null) clearTimeout(this.#restTimer);
    globalThis.removeEventListener?.('online', this.#onOnline);
    this.#viewers.clear();
    this.setIdle(true);
  }

  /** The sights of one view; empty if the view does not draw the scene. */
  protected sightsOf(view: object): readonly CloudSight[] {
    return this.#viewers.get(view)?.sights ?? [];
  }

  /** The sights of all views; the same array until they change. */
  protected get sights(): readonly CloudSight[] {
    this.#sights ??= [...this.#viewers.values()].flatMap(({ sights }) => sights);
    return this.#sights;
  }

  /** Extrapolated sights of moving views; the same array until they change. */
  protected get predicted(): readonly CloudSight[] {
    this.#predicted ??= this.#viewersInMotion.flatMap(({ motion }) => motion.predict());
    return this.#predicted;
  }

  /** Whether there are views and all of their sights are current. */
  protected get hasSights(): boolean {
    return this.#viewers.size > 0 && [...this.#viewers.values()].every(({ isCurrent }) => isCurrent);
  }

  /**
   * Resolves `complete` if nothing is being fetched or waits, and views have drawn the changes;
   * else makes it pending. Notifies listeners, and schedules waiting parts.
   */
  protected setIdle(isIdle: boolean): void {
    const isDrawn = this.#stale.size === 0 && !this.#isBehind;
    if (this.isEnded || (isIdle && isDrawn && !this.isWaiting)) {
      this.#wait?.end();
      this.#wait = null;
    } else this.#wait ??= pending();
    void this.#notifySoon();
    this.#scheduleApply(false);
  }

  /** @param isAfterFrame whether a view has just planned a frame. */
  #scheduleApply(isAfterFrame: boolean): void {
    if (this.isEnded || this.#isApplyDue || this.#holds.size > 0 || !this.isWaiting) return;
    if (this.#viewersInMotion.length > 0) {
      this.#awaitRest();
      if (!isAfterFrame) return;
    } else if (this.#drawing.size > 0) return;
    this.#isApplyDue = true;
    // As a microtask: a view that sets its sights is about to draw the current parts.
    queueMicrotask(() => this.#apply());
  }

  #apply(): void {
    this.#isApplyDue = false;
    if (this.isEnded || this.#holds.size > 0) return;
    this.flushUpdate();
    const isAtRest = this.#viewersInMotion.length === 0;
    const parts = this.applyPending(isAtRest ? Number.POSITIVE_INFINITY : this.#pace.most);
    this.#newParts += parts;
    if (parts > 0) this.redraw();
    else this.updateSoon();
  }

  /** Resolves when parts may be applied. */
  protected async untilFree(): Promise<void> {
    while (this.#holds.size > 0) await Promise.allSettled(this.#holds);
  }

  /** Makes all views draw the change: moving views with their own next frame, others at once. */
  protected redraw(): void {
    const nowMs = performance.now();
    for (const [view, viewer] of this.#viewers) {
      if (viewer.ownFrames.restMs(nowMs) > 0) viewer.isBehind = true;
      else void this.#redraw(view, viewer);
    }
    if (this.#isBehind) this.#awaitRest();
    this.updateSoon();
  }

  /** Whether a moving view has not yet drawn the change. */
  get #isBehind(): boolean {
    return [...this.#viewers.values()].some(({ isBehind }) => isBehind);
  }

  /** Views that draw frame after frame on their own. */
  get #viewersInMotion(): readonly Viewer[] {
    const nowMs = performance.now();
    return [...this.#viewers.values()].filter(({ ownFrames }) => ownFrames.restMs(nowMs) > 0);
  }

  /** Once views have come to rest, redraws them and applies waiting parts. */
  #awaitRest(): void {
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
        viewer.motion.stop();
        if (viewer.isBehind) void this.#redraw(view, viewer);
      }
      this.#predicted = null;
      if (this.#isBehind || this.predicted.length > 0) this.#awaitRest();
      this.updateSoon();
    }, Math.ceil(restMs));
  }

  /** Redraws a view, and once more if parts have changed meanwhile. */
  async #redraw(view: object, viewer: Viewer): Promise<void> {
    viewer.isBehind = false;
    this.#stale.add(view);
    if (this.#drawing.has(view)) return;
    this.#drawing.add(view);
    while (this.#stale.delete(view)) {
      viewer.isRequested = true;
      // The view itself reports errors.
      await viewer.redraw().catch(() => {});
    }
    this.#drawing.delete(view);
    if (!this.isEnded) this.updateSoon();
  }
}

function pending(): { readonly complete: Promise<void>; readonly end: () => void } {
  let end = () => {};
  const complete = new Promise<void>((resolve) => {
    end = resolve;
  });
  return { complete, end };
}
