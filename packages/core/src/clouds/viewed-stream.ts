import { SplatSourceError } from '../data/errors.ts';
import type { CloudSight, CloudStream, StreamReport } from './cloud-stream.ts';
import { FetchRate } from './fetch-rate.ts';

interface Viewer {
  readonly sights: readonly CloudSight[];
  /** Whether these are of its last frame. */
  readonly isCurrent: boolean;
  readonly redraw: () => Promise<unknown>;
}

/** What all streams do alike: they follow views, draw these again, and tell listeners and waits. */
export abstract class ViewedStream implements CloudStream {
  readonly #viewers = new Map<object, Viewer>();
  readonly #listeners = new Set<() => void>();
  /** Views that are drawing what has changed, and those that are to draw it once more. */
  readonly #drawing = new Set<object>();
  readonly #stale = new Set<object>();
  /** What is there must not change until these settle. */
  readonly #holds = new Set<Promise<unknown>>();
  readonly #onOnline = () => {
    if (this.error instanceof SplatSourceError) this.retry();
  };
  /** Settles when nothing is missing that could be there; null if it is so. */
  #wait: { readonly complete: Promise<void>; readonly end: () => void } | null = null;
  protected readonly rate = new FetchRate();
  /** Of the last fetch; nothing is fetched while there is one. */
  protected error: Error | null = null;
  protected isEnded = false;

  constructor() {
    // Pages and workers are told; elsewhere there is no such event.
    globalThis.addEventListener?.('online', this.#onOnline);
  }

  abstract report(): StreamReport;

  /** Views see something else, what is there may change again, or what failed is to be fetched. */
  protected abstract follow(): void;

  get complete(): Promise<void> | null {
    return this.#wait?.complete ?? null;
  }

  see(view: object, sights: readonly CloudSight[] | null, redraw: () => Promise<unknown>): void {
    const before = this.#viewers.get(view)?.sights ?? [];
    this.#viewers.set(view, { sights: sights ?? before, isCurrent: sights !== null, redraw });
    this.follow();
  }

  subscribe(listener: () => void): () => void {
    // Each call has an entry of its own.
    const entry = () => listener();
    this.#listeners.add(entry);
    return () => this.#listeners.delete(entry);
  }

  leave(view: object): void {
    this.#stale.delete(view);
    if (this.#viewers.delete(view)) this.follow();
  }

  hold(until: Promise<unknown>): void {
    this.#holds.add(until);
    const release = () => {
      this.#holds.delete(until);
      this.follow();
    };
    until.then(release, release);
  }

  retry(): void {
    this.error = null;
    this.follow();
  }

  end(): void {
    this.isEnded = true;
    globalThis.removeEventListener?.('online', this.#onOnline);
    this.#viewers.clear();
    this.settle(true);
    this.#listeners.clear();
  }

  /** What the views see. */
  protected get sights(): CloudSight[] {
    return [...this.#viewers.values()].flatMap(({ sights }) => sights);
  }

  /** Whether the needs of all views are known, of which there are some. */
  protected get isSeen(): boolean {
    return this.#viewers.size > 0 && [...this.#viewers.values()].every(({ isCurrent }) => isCurrent);
  }

  /** Whether what is there must not change. */
  protected get isHeld(): boolean {
    return this.#holds.size > 0;
  }

  /** Lets `complete` wait until nothing is under way any more, and tells listeners. */
  protected settle(isAtRest: boolean): void {
    if (isAtRest) {
      this.#wait?.end();
      this.#wait = null;
    } else this.#wait ??= pending();
    for (const listener of [...this.#listeners]) listener();
  }

  /** Draws all views again. */
  protected redraw(): void {
    for (const view of this.#viewers.keys()) void this.#redraw(view);
  }

  /** Draws a view again; once more after that, if anything has changed meanwhile. */
  async #redraw(view: object): Promise<void> {
    this.#stale.add(view);
    if (this.#drawing.has(view)) return;
    this.#drawing.add(view);
    // The view itself tells what fails.
    while (this.#stale.delete(view))
      await this.#viewers
        .get(view)
        ?.redraw()
        .catch(() => {});
    this.#drawing.delete(view);
  }
}

function pending(): { readonly complete: Promise<void>; readonly end: () => void } {
  let end = () => {};
  const complete = new Promise<void>((resolve) => {
    end = resolve;
  });
  return { complete, end };
}
