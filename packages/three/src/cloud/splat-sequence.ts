import { callListener, InvalidArgumentError, type SplatSource, shown } from '@websplatter/core';
import { EventDispatcher } from 'three/webgpu';
import { dispatch } from '../dispatch.ts';
import type { SplatData } from './splat-data.ts';
import type { SplatLoader } from './splat-loader.ts';

/** One frame is fetched while the one before is packed. */
const LOADS_AT_ONCE = 2;
/** The frame on the screen and the next one. */
const FEWEST_HELD = 2;
const DEFAULT_HELD = 4;
/** Timers have a resolution of 1 ms. */
const MOST_PER_S = 1000;
/** As in files of frames: durations stay finite. */
const LEAST_PER_S = 0.001;
/** Part of a frame by which a seek may fall short of the frame's beginning: rounding of seconds. */
const TIME_TOLERANCE = 1e-6;

/** Options of a `SplatSequence`. */
export interface SplatSequenceOptions {
  /** 0.001 to 1000; default 30. */
  readonly framesPerS?: number;
  /** Whether it plays from the beginning; default true. */
  readonly isPlaying?: boolean;
  /** Whether the first frame follows the last; default true. */
  readonly loop?: boolean;
  /**
   * Most frames in memory, including frames being loaded or still on the screen; at least 2. Default:
   * 4, or as many as `budgetBytes` has room for.
   */
  readonly maxHeldFrames?: number;
  /**
   * Most bytes of GPU memory for frames in memory, each counted as large as the largest so far; two
   * frames are kept in any case. Default: no limit but `maxHeldFrames`.
   */
  readonly budgetBytes?: number;
}

/** Loads one frame; `abort` cancels the load. */
export type FrameLoader = Pick<SplatLoader, 'abort' | 'loadAsync'>;

/** A frame in the pool. */
interface HeldFrame {
  readonly source: SplatSource;
  /** Null before it is made. */
  loader: FrameLoader | null;
  /** Null while it is loaded. */
  data: SplatData | null;
}

/** Events of a `SplatSequence`. */
export interface SplatSequenceEventMap {
  /** `data`, `frame` or `isBuffering` has changed. */
  change: object;
}

/**
 * Plays files one after the other, such as a 4D capture with a file for each frame. Keeps a few
 * frames in memory and prefetches the next ones; a frame on the screen stays until the next one is
 * drawn. Loads begin in a microtask after the constructor.
 *
 * A late page drops loaded frames to keep in time (`droppedFrames`). If the next frame is not loaded
 * yet, playback pauses at the present one (`isBuffering`) and continues from it. If a frame cannot
 * be read, the frame before stays for its time.
 *
 * @example
 * const makeLoader = () => new SplatLoader().detectSupport(renderer);
 * const sequence = new SplatSequence(['1.spz', '2.spz', '3.spz'], makeLoader, { framesPerS: 24 });
 * sequence.addEventListener('change', () => {
 *   cloud.data = sequence.data;
 * });
 */
export class SplatSequence extends EventDispatcher<SplatSequenceEventMap> {
  readonly frameCount: number;
  /**
   * Called once for each source that cannot be loaded, with the SplatFileError, SplatSourceError or
   * GpuLimitError and the source's first frame. The source is not loaded again. Without a listener,
   * errors go to the console.
   */
  onError: ((error: unknown, frame: number) => void) | null = null;
  readonly #sources: readonly SplatSource[];
  readonly #makeLoader: () => FrameLoader;
  readonly #budgetBytes: number | undefined;
  readonly #maxHeldFrames: number;
  readonly #pool = new Map<SplatSource, HeldFrame>();
  /** Dropped frames that are still on a GPU, or whose load is being aborted. */
  readonly #leaving = new Set<HeldFrame>();
  readonly #failed = new Set<SplatSource>();
  #largestBytes = 0;
  #framesPerS = 30;
  #isPlaying: boolean;
  #loop: boolean;
  #shown: HeldFrame | null = null;
  /** The frame before `#shown`: kept until `#shown` is drawn. */
  #previous: HeldFrame | null = null;
  #frame = 0;
  #droppedFrames = 0;
  /** Index of the frame at the present playback time; `#currentMs` is when it began. */
  #current = 0;
  #currentMs = 0;
  /** Whether playback waits until `#current` is loaded. */
  #isAwaited = true;
  #isDisposed = false;
  #timer: ReturnType<typeof setTimeout> | undefined;

  /**
   * @param sources sources of the frames, in order. A source of several frames is kept in memory once.
   *   Streams can be read once only.
   * @param makeLoader makes a loader for each frame. With `() => new
   *   SplatLoader().detectSupport(renderer)`, frames are prefetched into GPU memory; without
   *   `detectSupport` into main memory, and uploaded when they are first drawn.
   * @throws InvalidArgumentError for numbers that are out of range.
   */
  constructor(
    sources: readonly SplatSource[],
    makeLoader: () => FrameLoader,
    options: SplatSequenceOptions = {},
  ) {
    super();
    check(Array.isArray(sources), 'sources', shown(sources), 'a list of sources');
    const { framesPerS = 30, isPlaying = true, loop = true, budgetBytes } = options;
    const { maxHeldFrames = budgetBytes ? Number.POSITIVE_INFINITY : DEFAULT_HELD } = options;
    check(maxHeldFrames >= FEWEST_HELD, 'maxHeldFrames', maxHeldFrames, `${FEWEST_HELD} or more`);
    check(budgetBytes === undefined || budgetBytes > 0, 'budgetBytes', budgetBytes, 'above 0');
    this.#sources = [...sources];
    this.frameCount = sources.length;
    this.#makeLoader = makeLoader;
    this.#budgetBytes = budgetBytes;
    this.#maxHeldFrames = Math.floor(maxHeldFrames);
    this.framesPerS = framesPerS;
    this.#isPlaying = isPlaying;
    this.#loop = loop;
    this.#updateSoon();
  }

  /** The splats to show; null before the first frame is there, and after `dispose`. */
  get data(): SplatData | null {
    return this.#shown?.data ?? null;
  }

  /** Index of the frame in `data`; 0 before the first. */
  get frame(): number {
    return this.#frame;
  }

  /** Whether playback waits for a frame that is not loaded: at the beginning, after a seek, in a stall. */
  get isBuffering(): boolean {
    return this.#isAwaited && this.frameCount > 0;
  }

  /** Loaded frames that were skipped because the page was late. */
  get droppedFrames(): number {
    return this.#droppedFrames;
  }

  /** @throws InvalidArgumentError unless it is 0.001 to 1000. */
  get framesPerS(): number {
    return this.#framesPerS;
  }

  set framesPerS(framesPerS: number) {
    const isRate = framesPerS >= LEAST_PER_S && framesPerS <= MOST_PER_S;
    check(isRate, 'framesPerS', framesPerS, `${LEAST_PER_S} to ${MOST_PER_S}`);
    if (framesPerS === this.#framesPerS) return;
    this.#framesPerS = framesPerS;
    this.#updateSoon();
  }

  /** Stays true at the end of a sequence without `loop`, whose last frame stays until a seek. */
  get isPlaying(): boolean {
    return this.#isPlaying;
  }

  set isPlaying(isPlaying: boolean) {
    if (isPlaying === this.#isPlaying) return;
    this.#isPlaying = isPlaying;
    this.#currentMs = performance.now();
    this.#updateSoon();
  }

  /** Whether the first frame follows the last. */
  get loop(): boolean {
    return this.#loop;
  }

  set loop(loop: boolean) {
    if (loop === this.#loop) return;
    this.#loop = loop;
    // The last frame may have been shown for longer than its time.
    this.#currentMs = performance.now();
    this.#updateSoon();
  }

  /**
   * Goes to a frame (0…`frameCount` − 1), or to the frame at a time in seconds. Times wrap around if
   * the sequence loops, and are clamped otherwise. The present frame stays until the new one is
   * loaded; playback continues from there.
   *
   * @throws InvalidArgumentError for a frame out of range, and a time that is not finite.
   */
  seek(place: { readonly frame: number } | { readonly timeS: number }): void {
    this.#current = 'frame' in place ? this.#checked(place.frame) : this.#frameAt(place.timeS);
    this.#isAwaited = true;
    this.#update();
  }

  /** Ends playback and loads, and releases all frames. Clouds keep the frames that they show. */
  dispose(): void {
    this.#isDisposed = true;
    clearTimeout(this.#timer);
    for (const held of [...this.#pool.values()]) this.#drop(held);
    this.#shown = null;
    this.#previous = null;
  }

  #checked(frame: number): number {
    const isFrame = Number.isInteger(frame) && frame >= 0 && frame < this.frameCount;
    check(
      isFrame,
      'frame',
      frame,
      `a whole number from 0 and below ${this.frameCount}, the number of frames`,
    );
    return frame;
  }

  #frameAt(timeS: number): number {
    check(Number.isFinite(timeS), 'timeS', timeS, 'a finite number of seconds');
    const count = Math.max(1, this.frameCount);
    const frame = Math.floor(timeS * this.#framesPerS + TIME_TOLERANCE);
    return this.#loop ? ((frame % count) + count) % count : Math.min(Math.max(0, frame), count - 1);
  }

  /** Updates in a microtask: three may be drawing a frame, or the caller setting further options. */
  #updateSoon(): void {
    queueMicrotask(() => this.#update());
  }

  #update(): void {
    if (this.#isDisposed) return;
    const before = [this.#shown, this.#frame, this.isBuffering];
    this.#advance(performance.now());
    this.#hold();
    clearTimeout(this.#timer);
    if (this.#isPlaying && !this.#isAwaited && this.#after(this.#current) !== null)
      this.#timer = setTimeout(() => this.#update(), this.#nextMs - performance.now());
    if ([this.#shown, this.#frame, this.isBuffering].some((value, i) => value !== before[i]))
      dispatch(this, { type: 'change' });
  }

  /** Time at which the current frame ends, ms. */
  get #nextMs(): number {
    return this.#currentMs + 1000 / this.#framesPerS;
  }

  #after(frame: number): number | null {
    if (frame + 1 < this.frameCount) return frame + 1;
    return this.#loop && this.frameCount > 1 ? 0 : null;
  }

  /** Goes to the frame at the present time, or to the first frame before it that is not loaded. */
  #advance(nowMs: number): void {
    let due: number | null = null;
    if (this.#isAwaited) this.#currentMs = nowMs;
    for (;;) {
      const source = this.#sources[this.#current];
      if (this.#isAwaited && !this.#failed.has(source)) {
        if (!this.#pool.get(source)?.data) break;
        if (due !== null) this.#droppedFrames++;
        due = this.#current;
      }
      this.#isAwaited = false;
      const next = this.#after(this.#current);
      if (!this.#isPlaying || next === null || nowMs < this.#nextMs) break;
      this.#currentMs = this.#nextMs;
      this.#current = next;
      this.#isAwaited = true;
    }
    if (due !== null) this.#show(due);
  }

  #show(frame: number): void {
    const held = this.#pool.get(this.#sources[frame])!;
    if (held !== this.#shown) this.#previous = this.#shown;
    this.#shown = held;
    this.#frame = frame;
  }

  /** Evicts frames that are not needed now or next, and loads missing ones. */
  #hold(): void {
    if (this.#previous && isInUse(this.#shown!.data!)) this.#previous = null;
    const limit = this.#limit();
    const wanted = new Set([this.#shown, this.#previous].flatMap((held) => held?.source ?? []));
    let at: number | null = this.#current;
    for (let i = 0; i < this.frameCount && wanted.size < limit && at !== null; i++) {
      const source = this.#sources[at];
      if (!this.#failed.has(source)) wanted.add(source);
      at = this.#after(at);
    }
    for (const held of [...this.#pool.values()]) if (!wanted.has(held.source)) this.#drop(held);
    for (const held of this.#leaving) if (held.data && !isPlaced(held.data)) this.#leaving.delete(held);
    for (const source of wanted) {
      if (this.#pool.has(source) || this.#takeBack(source)) continue;
      const loads = [...this.#pool.values()].filter(({ data }) => !data).length;
      const hasRoom = this.#pool.size + this.#leaving.size < limit;
      if (hasRoom && loads < LOADS_AT_ONCE) void this.#load(source);
    }
  }

  #limit(): number {
    if (!this.#budgetBytes) return this.#maxHeldFrames;
    for (const { data } of this.#pool.values())
      for (const bytes of data ? bytesOf(data) : []) this.#largestBytes = Math.max(this.#largestBytes, bytes);
    // The fewest frames until a frame's size is known.
    const fitting = this.#largestBytes && Math.floor(this.#budgetBytes / this.#largestBytes);
    return Math.max(FEWEST_HELD, Math.min(this.#maxHeldFrames, fitting));
  }

  #drop(held: HeldFrame): void {
    this.#pool.delete(held.source);
    this.#leaving.add(held);
    // An error of a caller's own loader must not keep other frames from being evicted.
    callListener(() => (held.data ? held.data.dispose() : held.loader?.abort()));
  }

  /** Takes a frame that is still on a GPU back into the pool; returns false if there is none. */
  #takeBack(source: SplatSource): boolean {
    for (const held of this.#leaving) {
      if (held.source !== source || !held.data) continue;
      held.data.isCached = true;
      this.#leaving.delete(held);
      this.#pool.set(source, held);
      // Playback may wait for this frame.
      this.#updateSoon();
      return true;
    }
    return false;
  }

  async #load(source: SplatSource): Promise<void> {
    const held: HeldFrame = { source, loader: null, data: null };
    this.#pool.set(source, held);
    const isHeld = () => this.#pool.get(source) === held;
    let failure: { readonly error: unknown } | null = null;
    // `#makeLoader` is the caller's, and may change the sequence: call it after the present change.
    await null;
    try {
      if (isHeld()) held.loader = this.#makeLoader();
      const data = isHeld() ? await held.loader!.loadAsync(source) : null;
      if (data && isHeld()) {
        data.isCached = true;
        data.onUse = () => this.#updateSoon();
        held.data = data;
      } else data?.dispose();
    } catch (error) {
      if (isHeld()) {
        this.#pool.delete(source);
        this.#failed.add(source);
        failure = { error };
      }
    }
    if (!held.data) this.#leaving.delete(held);
    this.#update();
    if (!failure) return;
    if (this.onError) callListener(this.onError, failure.error, this.#sources.indexOf(source));
    else console.error(failure.error);
  }
}

function check(isRight: boolean, name: string, found: unknown, range: string): void {
  if (!isRight) throw new InvalidArgumentError(name, `${name} is ${found}; it must be ${range}.`);
}

function isPlaced({ places }: SplatData): boolean {
  return [...places].length > 0;
}

function isInUse(data: SplatData): boolean {
  return [...data.places].some(({ users }) => [...users.keys()].some((user) => user !== data));
}

function bytesOf({ places }: SplatData): number[] {
  return [...places].flatMap(({ cloud }) => (cloud instanceof Promise ? [] : cloud.bytes));
}

/**
 * Returns the files of a folder in the order of their paths, numbers in them by value: frame_-1.ply
 * comes before frame_0.ply.
 *
 * @example
 * // Files of a chosen folder: frame-2.ply comes before frame-10.ply.
 * const sources = inPathOrder(files);
 * const sequence = new SplatSequence(sources, () => new SplatLoader().detectSupport(renderer));
 */
export function inPathOrder(files: Iterable<File>): File[] {
  const all = Array.from(files, (file) => ({ file, path: file.webkitRelativePath || file.name }));
  const { compare } = new Intl.Collator('en', { numeric: true });
  // A hyphen is a minus after nothing, a slash or _, or after a text that numbers follow in other names.
  const stems = new Set(
    all.flatMap(({ path }) => Array.from(path.matchAll(/\d+/g), ({ index }) => path.slice(0, index))),
  );
  const isMinusAfter = (text: string) => /(^|[/_])$/.test(text) || stems.has(text);
  // Punctuation comes before digits.
  const keyOf = (name: string) =>
    name.replace(/[-−](\d+)/g, (found, digits, at) =>
      isMinusAfter(name.slice(0, at)) ? `!${1e15 - digits}` : found,
    );
  return all.sort((a, b) => compare(keyOf(a.path), keyOf(b.path))).map(({ file }) => file);
}
