import { type AccuracyRequest, DEFAULT_ACCURACY, lastingSource } from '@websplatter/core';

/** What may be loaded through the cache: URLs count by their address, everything else by identity. */
export type CacheableSource = string | URL | Blob | ArrayBuffer;

/** One file. */
export interface SplatRequest {
  readonly source: CacheableSource;
  /** What it is packed for if this request is the first for it: for another accuracy the GPU's copy is made anew. */
  readonly accuracy: AccuracyRequest;
  /** Equal for requests that share an entry. */
  readonly key: string;
}

/** How far a request has come. A new object whenever that changes, so that React can compare by identity. */
export type LoadState<Data> =
  /** `settled` resolves when the load has ended, well or not; it never rejects. */
  | { readonly status: 'pending'; readonly settled: Promise<void> }
  | { readonly status: 'loaded'; readonly data: Data }
  | { readonly status: 'failed'; readonly error: unknown };

export type LoadFunction<Data> = (
  request: SplatRequest,
  watch: { readonly signal: AbortSignal; readonly onProgress: (progress: ProgressEvent) => void },
) => Promise<Data>;

export interface CacheWatcher {
  /** The request's state is another one now. */
  readonly onChange?: () => void;
  readonly onProgress?: (progress: ProgressEvent) => void;
}

/** An entry outlives its last user by this much: StrictMode, hot reloads and changes of page unmount and mount again. */
export const GRACE_MS = 500;

/**
 * An entry that a render has asked for waits this long for a component to mount with it. Long, since the component may
 * have to wait for other files first, and dropping what it needs would make it start again.
 */
export const UNCLAIMED_GRACE_MS = 60_000;

interface Entry<Data> {
  readonly request: SplatRequest;
  readonly abort: AbortController;
  readonly watchers: Set<CacheWatcher>;
  state: LoadState<Data>;
  isPreloaded: boolean;
  dropTimer: ReturnType<typeof setTimeout> | undefined;
}

/**
 * Parsed files, shared by all who show them. An entry lives as long as somebody watches it and a moment longer;
 * dropping it aborts its load. Nothing in here is on a GPU.
 */
export class SplatCache<Data> {
  readonly #load: LoadFunction<Data>;
  readonly #entries = new Map<string, Entry<Data>>();

  constructor(load: LoadFunction<Data>) {
    this.#load = load;
  }

  /** Undefined where nobody has asked for it. */
  stateOf(request: SplatRequest): LoadState<Data> | undefined {
    return this.#entries.get(request.key)?.state;
  }

  /** Holds the request's entry, loading it where need be, until the function returned is called (with the grace to give). */
  watch(request: SplatRequest, watcher: CacheWatcher): (graceMs?: number) => void {
    const entry = this.#entryOf(request);
    clearTimeout(entry.dropTimer);
    entry.watchers.add(watcher);
    return (graceMs = GRACE_MS) => {
      // A failed entry goes at once, so that the next attempt is one.
      if (entry.watchers.delete(watcher))
        this.#dropLater(entry, entry.state.status === 'failed' ? 0 : graceMs);
    };
  }

  /** For a render, which cannot watch: starts the load and keeps it for a component that will. */
  ask(request: SplatRequest): LoadState<Data> {
    const entry = this.#entryOf(request);
    // React renders a component that has thrown once more at once: it must find the same failure, not a new attempt.
    this.#dropLater(entry, entry.state.status === 'failed' ? GRACE_MS : UNCLAIMED_GRACE_MS);
    return entry.state;
  }

  /** Loads ahead of use, and keeps until `clear`. */
  preload(request: SplatRequest): void {
    const entry = this.#entryOf(request);
    clearTimeout(entry.dropTimer);
    entry.isPreloaded = true;
  }

  /** Drops what was preloaded or awaits a component; what is in use goes with its last user. Undefined: of every source. */
  clear(source?: CacheableSource): void {
    const sourceKey = source === undefined ? undefined : sourceKeyOf(source);
    for (const entry of [...this.#entries.values()]) {
      if (sourceKey !== undefined && entry.request.key !== sourceKey) continue;
      entry.isPreloaded = false;
      this.#dropLater(entry, 0);
    }
  }

  #entryOf(request: SplatRequest): Entry<Data> {
    const existing = this.#entries.get(request.key);
    if (existing) return existing;
    const abort = new AbortController();
    const watchers = new Set<CacheWatcher>();
    const onProgress = (progress: ProgressEvent) => {
      for (const watcher of [...watchers]) watcher.onProgress?.(progress);
    };
    const settled = this.#load(request, { signal: abort.signal, onProgress }).then(
      (data) => this.#settle(entry, { status: 'loaded', data }),
      (error: unknown) => this.#settle(entry, { status: 'failed', error }),
    );
    const entry: Entry<Data> = {
      request,
      abort,
      watchers,
      state: { status: 'pending', settled },
      isPreloaded: false,
      dropTimer: undefined,
    };
    this.#entries.set(request.key, entry);
    return entry;
  }

  #settle(entry: Entry<Data>, state: LoadState<Data>): void {
    if (entry.abort.signal.aborted) return;
    entry.state = state;
    for (const watcher of [...entry.watchers]) watcher.onChange?.();
  }

  #dropLater(entry: Entry<Data>, graceMs: number): void {
    clearTimeout(entry.dropTimer);
    if (entry.watchers.size > 0 || entry.isPreloaded) return;
    if (graceMs === 0) this.#drop(entry);
    else entry.dropTimer = setTimeout(() => this.#drop(entry), graceMs);
  }

  #drop(entry: Entry<Data>): void {
    this.#entries.delete(entry.request.key);
    entry.abort.abort();
  }
}

/** What stands for `source` in a cache. */
export function requestFor(
  source: CacheableSource,
  accuracy: AccuracyRequest = DEFAULT_ACCURACY,
): SplatRequest {
  return { source, accuracy, key: sourceKeyOf(source) };
}

const objectKeys = new WeakMap<object, string>();
let objectCount = 0;

function sourceKeyOf(source: CacheableSource): string {
  if (typeof source === 'string' || source instanceof URL) {
    // One address has one entry, however it is written.
    return String(lastingSource(source));
  }
  let key = objectKeys.get(source);
  if (key === undefined) {
    key = `object ${++objectCount}`;
    objectKeys.set(source, key);
  }
  return key;
}
