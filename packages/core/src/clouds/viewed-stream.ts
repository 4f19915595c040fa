import { SplatSourceError } from '../data/errors.ts';
import { hasSameFields } from '../data/has-same-fields.ts';
import { Listeners } from '../data/listeners.ts';
import { nextTask } from '../data/turns.ts';
import type { CloudSight, CloudStream, StreamReport } from './cloud-stream.ts';
import type { CoarseSplats } from './coarse-splats.ts';
import { OwnFrames } from './own-frames.ts';
import { PartPace } from './part-pace.ts';
import { SightMotion } from './sight-motion.ts';

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
  isAsked: boolean;
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
  #foreseen: readonly CloudSight[] | null = null;
  readonly #listeners = new Listeners();
  #isTellDue = false;
  /** The report at the last notification of listeners, or when the first subscribed. */
  #told: StreamReport | null = null;
  /** Views that are being redrawn, and views that must then be redrawn once more. */
  readonly #drawing = new Set<object>();
  readonly #stale = new Set<object>();
  /** Parts must not be applied until these settle. */
  readonly #holds = new Set<Promise<unknown>>();
  readonly #onOnline = () => {
    if (this.error instanceof SplatSourceError) this.retry();
  };
  #isTurnDue = false;
  #isFollowDue = false;
  #isShown = false;
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
  protected abstract follow(): void;

  /**
   * Schedules one `update` for all changes of this task. As a microtask, so that frames are
   * submitted first and the device draws meanwhile.
   */
  protected followSoon(): void {
    if (this.#isFollowDue) return;
    this.#isFollowDue = true;
    queueMicrotask(() => this.catchUp());
  }

  /** Runs a scheduled `update` now, so that results are current. */
  protected catchUp(): void {
    if (!this.#isFollowDue) return;
    this.#isFollowDue = false;
    this.follow();
  }

  /** Resolves when the device has finished all submitted work. */
  protected abstract whenDone(): Promise<unknown>;

  /** Whether parts wait to be placed or removed. */
  protected abstract get isWaiting(): boolean;

  /**
   * Places or removes up to `mostParts` waiting parts; each keeps the device busy for a while.
   * Returns the number of parts, 0 if frames do not change.
   */
  protected abstract change(mostParts: number): number;

  get complete(): Promise<void> | null {
    this.catchUp();
    return this.#wait?.complete ?? null;
  }

  see(view: object, sights: readonly CloudSight[] | null, redraw: () => Promise<unknown>): void {
    let viewer = this.#viewers.get(view);
    if (!viewer) {
      viewer = {
        sights: [],
        isCurrent: false,
        redraw,
        ownFrames: new OwnFrames(),
        motion: new SightMotion(),
        isAsked: false,
        isBehind: false,
      };
      this.#viewers.set(view, viewer);
    }
    if (!viewer.isAsked) this.#follow(viewer.ownFrames);
    viewer.isAsked = false;
    viewer.isBehind = false;
    viewer.redraw = redraw;
    if (sights) viewer.motion.take(sights, performance.now());
    this.#know(viewer, sights);
    if (this.foreseen.length > 0) this.#awaitRest();
    this.#arrangeTurn(true);
  }

  /** Times a frame that is about to be submitted. */
  #follow(ownFrames: OwnFrames): void {
    const beginMs = performance.now();
    ownFrames.begin(beginMs);
    const { stepMs } = ownFrames;
    const newParts = this.#newParts;
    this.#newParts = 0;
    const end = () => {
      const endMs = performance.now();
      ownFrames.end(endMs);
      // Without a predecessor, a frame's time does not predict others.
      if (Number.isFinite(stepMs)) this.#pace.learn(newParts, endMs - beginMs, stepMs);
    };
    queueMicrotask(() => this.whenDone().then(end, end));
  }

  shown(): void {
    if (this.#isShown) return;
    this.#isShown = true;
    const begin = () => {
      this.isPictured = true;
      this.followSoon();
    };
    // Hosts submit the frame before they yield.
    queueMicrotask(() => this.whenDone().then(begin, begin));
  }

  learn(view: object, sights: readonly CloudSight[]): void {
    const viewer = this.#viewers.get(view);
    if (viewer) this.#know(viewer, sights);
  }

  #know(viewer: Viewer, sights: readonly CloudSight[] | null): void {
    viewer.isCurrent = sights !== null;
    if (sights) {
      viewer.sights = sights;
      this.#sights = null;
      this.#foreseen = null;
    }
    this.followSoon();
  }

  subscribe(listener: () => void): () => void {
    // Changes before the first subscription are not reported.
    if (this.#listeners.size === 0) this.#told = this.report();
    return this.#listeners.add(listener);
  }

  /**
   * Notifies listeners if the report has changed, in a task of its own. So a listener that retries
   * or draws cannot recurse, and other tasks run in between.
   */
  async #tellSoon(): Promise<void> {
    if (this.#isTellDue || this.#listeners.size === 0) return;
    this.#isTellDue = true;
    await nextTask();
    this.#isTellDue = false;
    const report = this.report();
    const isNew = !this.#told || !hasSameFields(this.#told, report);
    this.#told = report;
    if (isNew) this.#listeners.call();
    if (this.isEnded) this.#listeners.clear();
  }

  leave(view: object): void {
    this.#stale.delete(view);
    this.#sights = null;
    this.#foreseen = null;
    if (this.#viewers.delete(view)) this.follow();
  }

  hold(until: Promise<unknown>): void {
    this.#holds.add(until);
    const frames = [...this.#viewers.values()].map(({ ownFrames }) => ownFrames);
    for (const each of frames) each.prolong();
    const release = () => {
      this.#holds.delete(until);
      for (const each of frames) each.end(performance.now());
      this.followSoon();
    };
    until.then(release, release);
  }

  retry(): void {
    if (this.isEnded || this.error === null) return;
    this.error = null;
    // If it fails again with the same error, listeners are notified again.
    this.#told = null;
    this.followSoon();
  }

  end(): void {
    this.isEnded = true;
    if (this.#restTimer !== null) clearTimeout(this.#restTimer);
    globalThis.removeEventListener?.('online', this.#onOnline);
    this.#viewers.clear();
    this.settle(true);
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
  protected get foreseen(): readonly CloudSight[] {
    this.#foreseen ??= this.#viewersInMotion.flatMap(({ motion }) => motion.foresee());
    return this.#foreseen;
  }

  /** Whether there are views and all of their sights are current. */
  protected get isSeen(): boolean {
    return this.#viewers.size > 0 && [...this.#viewers.values()].every(({ isCurrent }) => isCurrent);
  }

  /**
   * Resolves `complete` if nothing is being fetched or waits, and views have drawn the changes;
   * else makes it pending. Notifies listeners, and schedules waiting parts.
   */
  protected settle(isAtRest: boolean): void {
    const isShown = this.#stale.size === 0 && !this.#isBehind;
    if (this.isEnded || (isAtRest && isShown && !this.isWaiting)) {
      this.#wait?.end();
      this.#wait = null;
    } else this.#wait ??= pending();
    void this.#tellSoon();
    this.#arrangeTurn(false);
  }

  /** @param isAfterFrame whether a view has just planned a frame. */
  #arrangeTurn(isAfterFrame: boolean): void {
    if (this.isEnded || this.#isTurnDue || this.#holds.size > 0 || !this.isWaiting) return;
    if (this.#viewersInMotion.length > 0) {
      this.#awaitRest();
      if (!isAfterFrame) return;
    } else if (this.#drawing.size > 0) return;
    this.#isTurnDue = true;
    // As a microtask: a view that sets its sights is about to draw the current parts.
    queueMicrotask(() => this.#takeTurn());
  }

  #takeTurn(): void {
    this.#isTurnDue = false;
    if (this.isEnded || this.#holds.size > 0) return;
    this.catchUp();
    const isAtRest = this.#viewersInMotion.length === 0;
    const parts = this.change(isAtRest ? Number.POSITIVE_INFINITY : this.#pace.most);
    this.#newParts += parts;
    if (parts > 0) this.redraw();
    else this.followSoon();
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
    this.followSoon();
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
      this.#foreseen = null;
      if (this.#isBehind || this.foreseen.length > 0) this.#awaitRest();
      this.followSoon();
    }, Math.ceil(restMs));
  }

  /** Redraws a view, and once more if parts have changed meanwhile. */
  async #redraw(view: object, viewer: Viewer): Promise<void> {
    viewer.isBehind = false;
    this.#stale.add(view);
    if (this.#drawing.has(view)) return;
    this.#drawing.add(view);
    while (this.#stale.delete(view)) {
      viewer.isAsked = true;
      // The view itself reports errors.
      await viewer.redraw().catch(() => {});
    }
    this.#drawing.delete(view);
    if (!this.isEnded) this.followSoon();
  }
}

function pending(): { readonly complete: Promise<void>; readonly end: () => void } {
  let end = () => {};
  const complete = new Promise<void>((resolve) => {
    end = resolve;
  });
  return { complete, end };
}
