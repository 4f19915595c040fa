import { SplatSourceError } from '../data/errors.ts';
import { hasSameFields } from '../data/has-same-fields.ts';
import { Listeners } from '../data/listeners.ts';
import { nextTask } from '../data/turns.ts';
import type { CloudSight, CloudStream, StreamReport } from './cloud-stream.ts';
import type { CoarseSplats } from './coarse-splats.ts';
import { OwnFrames } from './own-frames.ts';
import { PartPace } from './part-pace.ts';
import { SightMotion } from './sight-motion.ts';

/** Time over which bytes per second are counted. */
const WINDOW_MS = 2000;

/** Bytes per second of the last two seconds, or of those since fetching began. */
class FetchRate {
  /** Those of the window, oldest first. */
  #arrivals: readonly { readonly atMs: number; readonly bytes: number }[] = [];
  #beganMs = 0;

  /** Fetching begins, after nothing was being fetched. */
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
  /** Whether these are of its last frame. */
  isCurrent: boolean;
  redraw: () => Promise<unknown>;
  readonly ownFrames: OwnFrames;
  readonly motion: SightMotion;
  /** Whether the stream has asked for its next frame. */
  isAsked: boolean;
  /** Whether something has changed since its last frame, and its own next one is to show that. */
  isBehind: boolean;
}

/**
 * What all streams do alike: they follow views, draw these again, and tell listeners and waits.
 * What has arrived waits for its turn to change what is there. While a view draws frame after
 * frame by itself, there is a small turn after each of its frames, whose successor shows it; at
 * rest, turns take all and views are drawn again after each.
 */
export abstract class ViewedStream implements CloudStream {
  readonly #viewers = new Map<object, Viewer>();
  #sights: readonly CloudSight[] | null = null;
  #foreseen: readonly CloudSight[] | null = null;
  readonly #listeners = new Listeners();
  #isTellDue = false;
  /** The report that listeners were told of last, or that the first of them found. */
  #told: StreamReport | null = null;
  /** Views that are drawing what has changed, and those that are to draw it once more. */
  readonly #drawing = new Set<object>();
  readonly #stale = new Set<object>();
  /** What is there must not change until these settle. */
  readonly #holds = new Set<Promise<unknown>>();
  readonly #onOnline = () => {
    if (this.error instanceof SplatSourceError) this.retry();
  };
  #isTurnDue = false;
  #isFollowDue = false;
  #isShown = false;
  readonly #pace = new PartPace();
  /** Parts that have come or gone since a frame. */
  #newParts = 0;
  /** Runs until views may be at rest that draw by themselves. */
  #restTimer: ReturnType<typeof setTimeout> | null = null;
  /** Settles when nothing is missing that could be there; null if it is so. */
  #wait: { readonly complete: Promise<void>; readonly end: () => void } | null = null;
  protected readonly rate = new FetchRate();
  /** Of the last fetch; nothing is fetched while there is one. */
  protected error: Error | null = null;
  protected isEnded = false;
  /** Whether there is a picture of the scene. */
  protected isPictured = false;

  constructor() {
    // Pages and workers are told; elsewhere there is no such event.
    globalThis.addEventListener?.('online', this.#onOnline);
  }

  abstract report(): StreamReport;

  abstract missingFor(view: object): number;
  abstract lackingCells(): Set<number>;
  abstract coarse(signal?: AbortSignal): Promise<CoarseSplats>;

  /** Views see something else, what is there may change again, or what failed is to be fetched. */
  protected abstract follow(): void;

  /**
   * Lets `follow` be called once for all that happens in a turn of the thread. Frames are submitted
   * first, so that the device draws meanwhile.
   */
  protected followSoon(): void {
    if (this.#isFollowDue) return;
    this.#isFollowDue = true;
    queueMicrotask(() => this.catchUp());
  }

  /** Follows now what is to be followed soon: before anything is told of it. */
  protected catchUp(): void {
    if (!this.#isFollowDue) return;
    this.#isFollowDue = false;
    this.follow();
  }

  /** Resolves when the device has done all that was submitted. */
  protected abstract whenDone(): Promise<unknown>;

  /** Whether something has arrived, or is to go, that waits for its turn. */
  protected abstract get isWaiting(): boolean;

  /**
   * Changes what is there, by what waits: at most by so many parts, which take the device a while.
   * Returns how many there were, or 0 if views show the same as before.
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

  /** Takes a frame that is about to be submitted. */
  #follow(ownFrames: OwnFrames): void {
    const beginMs = performance.now();
    ownFrames.begin(beginMs);
    const { stepMs } = ownFrames;
    const newParts = this.#newParts;
    this.#newParts = 0;
    const end = () => {
      const endMs = performance.now();
      ownFrames.end(endMs);
      // Frames that follow none tell nothing of others.
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
    // Hosts submit it before they yield.
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
    // Nobody was told of changes while nobody listened; the first listener sees the report as it is.
    if (this.#listeners.size === 0) this.#told = this.report();
    return this.#listeners.add(listener);
  }

  /**
   * Tells listeners if the report has changed. In a task of its own, after all changes of this one: a
   * listener that retries or draws leads to the next call, and others get their turns before that.
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
    // The same failure is told again.
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

  /** What one view sees. */
  protected sightsOf(view: object): readonly CloudSight[] {
    return this.#viewers.get(view)?.sights ?? [];
  }

  /** What the views see: the same list until that changes. */
  protected get sights(): readonly CloudSight[] {
    this.#sights ??= [...this.#viewers.values()].flatMap(({ sights }) => sights);
    return this.#sights;
  }

  /** What views in motion will see soon: the same list until that changes. */
  protected get foreseen(): readonly CloudSight[] {
    this.#foreseen ??= this.#viewersInMotion.flatMap(({ motion }) => motion.foresee());
    return this.#foreseen;
  }

  /** Whether the needs of all views are known, of which there are some. */
  protected get isSeen(): boolean {
    return this.#viewers.size > 0 && [...this.#viewers.values()].every(({ isCurrent }) => isCurrent);
  }

  /**
   * Lets `complete` wait until nothing is under way any more and views show it, and tells listeners.
   * What waits gets its turn.
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
    // A view that says what it sees is about to draw what is there.
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

  /** Settles when what is there may change. */
  protected async untilFree(): Promise<void> {
    while (this.#holds.size > 0) await Promise.allSettled(this.#holds);
  }

  /** Has all views show what has changed: by their own next frames where they draw by themselves. */
  protected redraw(): void {
    const nowMs = performance.now();
    for (const [view, viewer] of this.#viewers) {
      if (viewer.ownFrames.restMs(nowMs) > 0) viewer.isBehind = true;
      else void this.#redraw(view, viewer);
    }
    if (this.#isBehind) this.#awaitRest();
    this.followSoon();
  }

  /** Whether the next frame of a view is to show what has changed. */
  get #isBehind(): boolean {
    return [...this.#viewers.values()].some(({ isBehind }) => isBehind);
  }

  /** Those that draw frame after frame by themselves. */
  get #viewersInMotion(): readonly Viewer[] {
    const nowMs = performance.now();
    return [...this.#viewers.values()].filter(({ ownFrames }) => ownFrames.restMs(nowMs) > 0);
  }

  /** Draws views that have come to rest, and gives what waits its turn. */
  #awaitRest(): void {
    if (this.#restTimer !== null) return;
    const nowMs = performance.now();
    const restMs = this.#viewersInMotion.reduce(
      (most, { ownFrames }) => Math.max(most, ownFrames.restMs(nowMs)),
      0,
    );
    // Even if they have just come to rest: what waits, waits for this alone.
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

  /** Draws a view again; once more after that, if anything has changed meanwhile. */
  async #redraw(view: object, viewer: Viewer): Promise<void> {
    viewer.isBehind = false;
    this.#stale.add(view);
    if (this.#drawing.has(view)) return;
    this.#drawing.add(view);
    while (this.#stale.delete(view)) {
      viewer.isAsked = true;
      // The view itself tells what fails.
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
