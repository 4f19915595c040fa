import { SplatSourceError } from '../../data/errors.ts';
import { hasSameFields } from '../../data/has-same-fields.ts';
import { Listeners } from '../../data/listeners.ts';
import { nextTask } from '../../data/turns.ts';
import { MOST_REQUESTS } from '../../io/sources/few-requests.ts';
import type { CloudSight } from './cloud-sight.ts';
import type { CloudStream, CoarseSplats, StreamReport } from './cloud-stream.ts';
import { type PartLimit, SceneViewers, type Sights } from './scene-viewers.ts';

/**
 * Parts that are being fetched, or have been fetched and wait in memory while the GPU's contents
 * must not change; a few hundred kilobytes each.
 */
const MOST_FETCHED = 64;

/** A part of a scene that is not on the GPU: a brick, or a file with levels of leaves. */
export interface MissingPart {
  /** Identifies the part. */
  readonly number: number;
  /** Whether views need it now, and not only if they move on as predicted. */
  readonly isNeeded: boolean;
  /** Whether there is or will be room for it. */
  readonly fits: boolean;
}

/** Events of parts that are being fetched or uploaded. */
export interface PartEvents {
  /** Called with the number of bytes fetched since the last call. */
  onBytes(bytes: number): void;
  /** Called if a fetch has decoded something before its end: the plan may change. */
  onProgress(): void;
  /** Called once a fetched part has been placed, dropped, or divided into pieces that wait. */
  onSettled(number: number): void;
  /** Called if a part contradicts those on the GPU. */
  onError(error: Error): void;
}

/** What a scene must give to be streamed, in the order of the steps of `SceneStream`. */
export interface SceneParts<Part extends MissingPart> {
  /**
   * Whether plans depend on how far a budget shifts thresholds, `squaredShift`. Sights without it are
   * unknown then.
   */
  readonly needsShift: boolean;
  /** 1. Plans which parts are to be on the GPU. Returns the missing ones, the most valuable first. */
  plan(sights: Sights): readonly Part[];

  /**
   * 2. The parts that are fetched with `first` in one request.
   *
   * @param partAt the part of this number if it may be fetched with `first`.
   * @param isPictured whether a first picture of the scene has been drawn.
   * @returns at most `mostParts`; none if `first` is to be fetched later.
   */
  requestWith(
    first: Part,
    partAt: (number: number) => Part | null,
    mostParts: number,
    isPictured: boolean,
  ): readonly Part[];
  /** Fetches a part. It counts as being fetched until `onSettled` is called, or this rejects. */
  fetch(part: Part, signal: AbortSignal, events: PartEvents): Promise<void>;

  /** Whether parts that views need are fetched only once the views rest, since they would pass them by. */
  readonly isHolding: boolean;

  /** 3. Whether parts wait to be placed or removed. */
  readonly isWaiting: boolean;
  /**
   * Places or removes waiting parts up to a limit; each keeps the device busy for a while. Returns the
   * number of parts, 0 if frames do not change.
   */
  upload(limit: PartLimit, events: PartEvents): number;

  /** Resizes the GPU memory of the parts; the most valuable ones stay. */
  resize(bytes: number, sights: Sights): void;
  /** Resolves when the device has finished all submitted work. */
  whenDone(): Promise<unknown>;
  /** Ends all reads. */
  end(): void;

  report(): Omit<StreamReport, 'fetching' | 'bytesPerSecond' | 'error'>;
  /** Count of parts that are not on the GPU, and that a view with these sights would draw. */
  missingFor(sights: readonly CloudSight[]): number;
  /** See `CloudStream`. */
  lackingCells(): Set<number>;
  /** See `CloudStream`. */
  coarse(signal: AbortSignal | undefined, events: PartEvents): Promise<CoarseSplats>;
}

/** Listeners are told of bytes alone at most so often, ms. */
const BYTES_NOTE_MS = 100;
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

  add(bytes: number): void {
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

interface Fetch {
  /** The parts of its request. */
  readonly request: readonly MissingPart[];
  readonly ending: AbortController;
  /** False once the part waits to be uploaded. */
  isRunning: boolean;
}

/**
 * Keeps the parts of one scene on the GPU that its viewers need most, in three steps: what is wanted, what
 * is fetched, what is uploaded. `#update` runs the first two whenever something has changed.
 * Fetched parts wait for the third, because the GPU's contents must change between frames only.
 * While a view draws frame after frame on its own, a few parts are uploaded after each frame, and
 * its next frame draws them. At rest, all are uploaded at once, and views are redrawn.
 */
export class SceneStream<Part extends MissingPart = MissingPart> implements CloudStream {
  readonly #parts: SceneParts<Part>;
  readonly #viewers: SceneViewers;
  /** Missing parts of the last plan: the same array while nothing has changed. */
  #planned: readonly Part[] = [];
  /** The same by number. */
  #plannedByNumber: ReadonlyMap<number, Part> = new Map();
  /** By number of the part, until it is settled. */
  readonly #fetches = new Map<number, Fetch>();
  readonly #rate = new FetchRate();
  /** Error of the last fetch; while it is set, nothing is fetched. */
  #error: Error | null = null;
  /** Parts must not be uploaded until these settle. */
  readonly #holds = new Set<Promise<unknown>>();
  #isUpdateDue = false;
  #isUploadDue = false;
  #hasFrame = false;
  /** Whether a first picture of the scene has been drawn. */
  #isPictured = false;
  #isEnded = false;
  /** Pending while parts that fit are missing, waiting or not yet drawn; else null. */
  #wait: { readonly complete: Promise<void>; readonly end: () => void } | null = null;
  readonly #listeners = new Listeners();
  #isNotifyDue = false;
  /** Runs until listeners are told of bytes. */
  #bytesTimer: ReturnType<typeof setTimeout> | null = null;
  readonly #noteBytes = () => {
    this.#bytesTimer = null;
    void this.#notifySoon();
  };
  /** The report at the last notification of listeners, or when the first subscribed. */
  #reported: StreamReport | null = null;
  readonly #events: PartEvents = {
    onBytes: (bytes) => {
      this.#rate.add(bytes);
      if (this.#listeners.size > 0) this.#bytesTimer ??= setTimeout(this.#noteBytes, BYTES_NOTE_MS);
    },
    onProgress: () => this.#update(),
    onSettled: (number) => this.#fetches.delete(number),
    onError: (error) => {
      this.#error = error;
    },
  };
  readonly #onOnline = () => {
    if (this.#error instanceof SplatSourceError) this.retry();
  };

  constructor(parts: SceneParts<Part>) {
    this.#parts = parts;
    this.#viewers = new SceneViewers(
      () => parts.whenDone(),
      () => this.#updateSoon(),
    );
    // The event exists on pages and in workers only.
    globalThis.addEventListener?.('online', this.#onOnline);
  }

  // 1. What is wanted

  /**
   * Schedules one `#update` for all changes of this task. As a microtask, so that frames are
   * submitted first and the device draws meanwhile.
   */
  #updateSoon(): void {
    if (this.#isUpdateDue) return;
    this.#isUpdateDue = true;
    queueMicrotask(() => this.#flushUpdate());
  }

  /** Runs a scheduled `#update` now, so that results are current. */
  #flushUpdate(): void {
    if (!this.#isUpdateDue) return;
    this.#isUpdateDue = false;
    this.#update();
  }

  #update(): void {
    if (this.#isEnded) return;
    const missing = this.#parts.plan(this.#viewers);
    if (missing !== this.#planned)
      this.#plannedByNumber = new Map(missing.map((part) => [part.number, part]));
    this.#planned = missing;
    const isFetching = this.#fetchMissing();
    this.#onUpdated(!isFetching);
  }

  // 2. What is fetched

  /**
   * Fetches parts that views lack, then parts that they are about to lack, and aborts all other
   * fetches. Returns whether parts that views lack are to be fetched, or being fetched.
   */
  #fetchMissing(): boolean {
    for (const [number, { ending }] of this.#fetches) if (!this.#plannedByNumber.has(number)) ending.abort();
    if (this.#error) return this.#fetches.size > 0;
    const areNeededFetched = () => !this.#planned.some((part) => part.isNeeded && this.#mayFetch(part));
    this.#fetchInOrder(true, this.#neededFetches);
    if (areNeededFetched()) this.#fetchInOrder(false, [...this.#fetches.values()]);
    const isDone = this.#neededFetches.length === 0 && !this.#parts.isHolding;
    return !isDone || !(this.#isPictured || areNeededFetched());
  }

  #mayFetch({ number, fits }: Part): boolean {
    return fits && !this.#fetches.has(number);
  }

  /** Fetches of parts that views need now, and aborted fetches that have not ended. */
  get #neededFetches(): readonly Fetch[] {
    const isNeeded = (number: number) => this.#plannedByNumber.get(number)?.isNeeded;
    return [...this.#fetches].flatMap(([number, fetch]) =>
      fetch.ending.signal.aborted || isNeeded(number) ? fetch : [],
    );
  }

  /**
   * @param areNeeded whether to fetch only parts that views need now.
   * @param others fetches that count towards the limits of concurrent ones.
   */
  #fetchInOrder(areNeeded: boolean, others: readonly Fetch[]): void {
    const requests = new Set(others.flatMap(({ request, isRunning }) => (isRunning ? [request] : [])));
    let places = MOST_FETCHED - others.length;
    const mayFetch = (part: Part) => (part.isNeeded || !areNeeded) && this.#mayFetch(part);
    const partAt = (number: number) => {
      const part = this.#plannedByNumber.get(number);
      return part && mayFetch(part) ? part : null;
    };
    for (const first of this.#planned) {
      if (requests.size >= MOST_REQUESTS || places <= 0) return;
      if (!mayFetch(first)) continue;
      const request = this.#parts.requestWith(first, partAt, places, this.#isPictured);
      if (request.length === 0) return;
      requests.add(request);
      places -= request.length;
      for (const part of request) void this.#fetch(part, request);
    }
  }

  async #fetch(part: Part, request: readonly Part[]): Promise<void> {
    const fetch: Fetch = { request, ending: new AbortController(), isRunning: true };
    const { signal } = fetch.ending;
    if (this.#fetches.size === 0) this.#rate.begin();
    this.#fetches.set(part.number, fetch);
    try {
      await this.#parts.fetch(part, signal, this.#events);
      fetch.isRunning = false;
    } catch (error) {
      this.#fetches.delete(part.number);
      if (!signal.aborted) this.#error = error as Error;
    }
    this.#updateSoon();
  }

  retry(): void {
    if (this.#isEnded || this.#error === null) return;
    this.#error = null;
    // If it fails again with the same error, listeners are notified again.
    this.#reported = null;
    this.#updateSoon();
  }

  // 3. What is uploaded

  /** @param isAfterFrame whether a view has just planned a frame. */
  #scheduleUpload(isAfterFrame: boolean): void {
    if (this.#isEnded || this.#isUploadDue || this.#holds.size > 0 || !this.#parts.isWaiting) return;
    if (this.#viewers.areMoving) {
      this.#viewers.awaitRest();
      if (!isAfterFrame) return;
    } else if (this.#viewers.areRedrawing) return;
    this.#isUploadDue = true;
    // As a microtask: a view that sets its sights is about to draw the current parts.
    queueMicrotask(() => this.#upload());
  }

  #upload(): void {
    this.#isUploadDue = false;
    if (this.#isEnded || this.#holds.size > 0) return;
    this.#flushUpdate();
    const newParts = this.#parts.upload(this.#viewers.limit, this.#events);
    if (newParts > 0) this.#viewers.redraw(newParts);
    else this.#updateSoon();
  }

  deferUploads(until: Promise<unknown>): void {
    this.#holds.add(until);
    const endFrames = this.#viewers.prolongFrames();
    const release = () => {
      this.#holds.delete(until);
      endFrames();
      this.#updateSoon();
    };
    until.then(release, release);
  }

  /** Resizes the GPU memory of the scene once parts may be uploaded. */
  async resize(bytes: number): Promise<void> {
    // Whoever holds the uploads reports errors of their own work.
    while (this.#holds.size > 0) await Promise.allSettled(this.#holds);
    if (this.#isEnded) return;
    this.#parts.resize(bytes, this.#viewers);
    this.#viewers.redraw();
  }

  // Views and their frames

  setSights(view: object, sights: readonly CloudSight[], redraw: () => Promise<unknown>): void {
    const isUnknown = this.#parts.needsShift && sights.some(({ squaredShift }) => squaredShift === null);
    this.#viewers.set(view, isUnknown ? null : sights, redraw);
    this.#scheduleUpload(true);
  }

  updateSights(view: object, sights: readonly CloudSight[]): void {
    if (this.#parts.needsShift) this.#viewers.update(view, sights);
  }

  onFrame(): void {
    if (this.#hasFrame) return;
    this.#hasFrame = true;
    const begin = () => {
      this.#isPictured = true;
      this.#updateSoon();
    };
    // Hosts submit the frame before they yield.
    queueMicrotask(() => this.#parts.whenDone().then(begin, begin));
  }

  leave(view: object): void {
    if (this.#viewers.remove(view)) this.#update();
  }

  // State

  /**
   * Resolves `complete` if nothing is being fetched or waits, and views have drawn the changes;
   * else makes it pending. Notifies listeners, and schedules waiting parts.
   */
  #onUpdated(isFetched: boolean): void {
    const isDone = isFetched && this.#viewers.areUpToDate && !this.#parts.isWaiting;
    if (this.#isEnded || isDone) {
      this.#wait?.end();
      this.#wait = null;
    } else this.#wait ??= pending();
    void this.#notifySoon();
    this.#scheduleUpload(false);
  }

  get complete(): Promise<void> | null {
    this.#flushUpdate();
    return this.#wait?.complete ?? null;
  }

  report(): StreamReport {
    this.#flushUpdate();
    const { fetchedBytes, isComplete, ...counts } = this.#parts.report();
    const fetching = this.#fetches.size;
    return {
      ...counts,
      fetching,
      fetchedBytes,
      bytesPerSecond: fetching > 0 ? this.#rate.bytesPerSecond : 0,
      isComplete: this.#viewers.areCurrent && isComplete,
      error: this.#error,
    };
  }

  missingFor(view: object): number {
    return this.#parts.missingFor(this.#viewers.sightsOf(view));
  }

  lackingCells(): Set<number> {
    this.#flushUpdate();
    return this.#parts.lackingCells();
  }

  coarse(signal?: AbortSignal): Promise<CoarseSplats> {
    return this.#parts.coarse(signal, this.#events);
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
    if (this.#isEnded) this.#listeners.clear();
  }

  end(): void {
    for (const { ending } of this.#fetches.values()) ending.abort();
    if (this.#bytesTimer !== null) clearTimeout(this.#bytesTimer);
    this.#parts.end();
    this.#isEnded = true;
    globalThis.removeEventListener?.('online', this.#onOnline);
    this.#viewers.end();
    this.#onUpdated(true);
  }
}

function pending(): { readonly complete: Promise<void>; readonly end: () => void } {
  let end = () => {};
  const complete = new Promise<void>((resolve) => {
    end = resolve;
  });
  return { complete, end };
}
