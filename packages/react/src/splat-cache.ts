import {
  type AccuracyRequest,
  callListener,
  InvalidArgumentError,
  lastingSource,
  type SceneFiles,
  type SourceOptions,
  type SplatFrame,
} from '@websplatter/core';

/** A file of splats, by its URL or in memory. URLs are compared by address, everything else by identity. */
export type SplatFileSource = string | URL | Blob | ArrayBuffer | SceneFiles | SplatFrame;

/** A request for one file. */
export interface SplatRequest {
  readonly source: SplatFileSource;
  /**
   * Accuracy that the file is packed for; default the renderer's. The first request decides; for
   * another accuracy, planes are made anew.
   */
  readonly accuracy: AccuracyRequest | null | undefined;
  /** Renderer that the file is loaded for; undefined outside of a Canvas. The first request decides. */
  readonly renderer: object | undefined;
  /** Options of reading the file. The first request decides. */
  readonly sourceOptions: SourceOptions | undefined;
  /** Most bytes of GPU memory for a streamed scene. The first request for a file decides. */
  readonly budgetBytes: number | undefined;
  /** Equal for requests that share an entry. */
  readonly key: string;
}

/** State of a request. Each change creates a new object, so that React can compare by identity. */
export type LoadState<Data> =
  | {
      readonly status: 'pending';
      /** Resolves when the load has succeeded or failed; never rejects. */
      readonly settled: Promise<void>;
      /** A preview; null if there is none yet. */
      readonly data: Data | null;
      /** The only renderer that can show the preview. */
      readonly renderer: object | undefined;
    }
  | { readonly status: 'loaded'; readonly data: Data }
  | { readonly status: 'failed'; readonly error: unknown };

export type LoadFunction<Data> = (
  request: SplatRequest,
  watch: {
    readonly signal: AbortSignal;
    readonly onProgress: (progress: ProgressEvent) => void;
    readonly onPreview: (preview: Data) => void;
  },
) => Promise<Data>;

export interface CacheWatcher {
  /** Called when the request's state has changed. */
  readonly onChange?: () => void;
  readonly onProgress?: (progress: ProgressEvent) => void;
}

/** Time that an entry outlives its last user, ms: StrictMode, hot reloads and new pages mount again. */
export const GRACE_MS = 500;

/**
 * Time that an entry requested by a render waits for its component to mount, ms. It is long because
 * the component may suspend for other files first, and would start again if its entry were dropped.
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
 * Loaded files, shared by all components that use them. An entry lives as long as it is watched, and
 * GRACE_MS longer; dropping it aborts its load, or disposes of the data.
 */
export class SplatCache<Data> {
  readonly #load: LoadFunction<Data>;
  readonly #dispose: (data: Data) => void;
  readonly #entries = new Map<string, Entry<Data>>();

  constructor(load: LoadFunction<Data>, dispose: (data: Data) => void) {
    this.#load = load;
    this.#dispose = dispose;
  }

  /** Returns the state of a request; undefined if the cache has no entry for it. */
  stateOf(request: SplatRequest): LoadState<Data> | undefined {
    return this.#entries.get(request.key)?.state;
  }

  /** Holds the request's entry, and loads it if necessary, until the result is called. */
  watch(request: SplatRequest, watcher: CacheWatcher): () => void {
    const entry = this.#entryOf(request);
    clearTimeout(entry.dropTimer);
    entry.watchers.add(watcher);
    return () => {
      // A failed entry is dropped at once, so that the next request loads again.
      if (entry.watchers.delete(watcher))
        this.#dropLater(entry, entry.state.status === 'failed' ? 0 : GRACE_MS);
    };
  }

  /** Starts a load during a render, and keeps it until the component mounts and watches it. */
  ask(request: SplatRequest): LoadState<Data> {
    const entry = this.#entryOf(request);
    // React renders a component that threw a second time: it must find the same failure.
    this.#dropLater(entry, entry.state.status === 'failed' ? GRACE_MS : UNCLAIMED_GRACE_MS);
    return entry.state;
  }

  /** Prefetches a file, and keeps it until `clear`. */
  preload(request: SplatRequest): void {
    const entry = this.#entryOf(request);
    clearTimeout(entry.dropTimer);
    entry.isPreloaded = true;
  }

  /**
   * Drops entries that were preloaded or await a component, of `source` or all; entries in use go
   * with their last user.
   */
  clear(source?: SplatFileSource): void {
    for (const entry of [...this.#entries.values()]) {
      if (source !== undefined && entry.request.key !== sourceKeyOf(source)) continue;
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
      for (const { onProgress } of [...watchers]) callListener(onProgress, progress);
    };
    const onPreview = (preview: Data) => this.#change(entry, { ...pending, data: preview });
    const settled = this.#load(request, { signal: abort.signal, onProgress, onPreview }).then(
      (data) => this.#change(entry, { status: 'loaded', data }),
      (error: unknown) => this.#change(entry, { status: 'failed', error }),
    );
    const pending = { status: 'pending', settled, data: null, renderer: request.renderer } as const;
    const entry: Entry<Data> = {
      request,
      abort,
      watchers,
      state: pending,
      isPreloaded: false,
      dropTimer: undefined,
    };
    this.#entries.set(request.key, entry);
    return entry;
  }

  #change(entry: Entry<Data>, state: LoadState<Data>): void {
    entry.state = state;
    if (entry.abort.signal.aborted) {
      this.#drop(entry);
      return;
    }
    for (const { onChange } of [...entry.watchers]) callListener(onChange);
  }

  #dropLater(entry: Entry<Data>, graceMs: number): void {
    clearTimeout(entry.dropTimer);
    if (entry.watchers.size > 0 || entry.isPreloaded) return;
    if (graceMs === 0) this.#drop(entry);
    else entry.dropTimer = setTimeout(() => this.#drop(entry), graceMs);
  }

  #drop(entry: Entry<Data>): void {
    if (this.#entries.get(entry.request.key) === entry) this.#entries.delete(entry.request.key);
    entry.abort.abort();
    if (entry.state.status === 'loaded') this.#dispose(entry.state.data);
  }
}

/**
 * Returns the request for `source`.
 *
 * @throws InvalidArgumentError for an empty URL, which would resolve to the page's own.
 */
export function requestFor(
  source: SplatFileSource,
  accuracy?: AccuracyRequest | null,
  renderer?: object,
  sourceOptions?: SourceOptions,
  budgetBytes?: number,
): SplatRequest {
  if (source === '')
    throw new InvalidArgumentError('source', 'The address is empty. Pass null for no splats.');
  return { source, accuracy, renderer, sourceOptions, budgetBytes, key: sourceKeyOf(source) };
}

const objectKeys = new WeakMap<object, string>();
let objectCount = 0;

function sourceKeyOf(source: SplatFileSource): string {
  const lasting = lastingSource(source);
  // URLs are resolved: relative and absolute forms share an entry.
  if (typeof lasting === 'string') return lasting;
  const object = source as Exclude<SplatFileSource, string | URL>;
  let key = objectKeys.get(object);
  if (key === undefined) {
    key = `object ${++objectCount}`;
    objectKeys.set(object, key);
  }
  return key;
}
