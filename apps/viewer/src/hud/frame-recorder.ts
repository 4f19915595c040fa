import type { FrameStatistics } from '@websplatter/core';
import type { ViewerState, ViewerStore } from '../state/store.ts';

/** The last values of a row, at most `capacity` of them. */
export class Ring<Value> {
  readonly capacity: number;
  readonly #values: Value[] = [];
  /** Index of the oldest value, which is overwritten next, once the recorder is full. */
  #next = 0;

  constructor(capacity: number) {
    this.capacity = capacity;
  }

  push(value: Value): void {
    this.#values[this.#next] = value;
    this.#next = (this.#next + 1) % this.capacity;
  }

  clear(): void {
    this.#values.length = 0;
    this.#next = 0;
  }

  /** The values, oldest first. */
  toArray(): Value[] {
    const isFull = this.#values.length === this.capacity;
    return isFull
      ? [...this.#values.slice(this.#next), ...this.#values.slice(0, this.#next)]
      : [...this.#values];
  }
}

/** Five seconds at 60 frames a second. */
export const HISTORY_FRAMES = 300;

export type Side = 'left' | 'right';

/** Keeps statistics of the last frames, of both sides of a split image, unless frozen. */
export class FrameRecorder {
  readonly #store: ViewerStore;
  readonly #frames: Readonly<Record<Side, Ring<FrameStatistics>>> = {
    left: new Ring(HISTORY_FRAMES),
    right: new Ring(HISTORY_FRAMES),
  };
  readonly #renderMs = new Ring<number>(HISTORY_FRAMES);
  readonly #ownMs = new Ring<number>(HISTORY_FRAMES);
  /** CPU time of calls to the engine since the last frame. */
  #calledMs = 0;
  /** CPU time that the figures have taken since then. */
  #spentMs = 0;
  #revision = 0;
  #frozen: ViewerState | null = null;

  constructor(store: ViewerStore) {
    this.#store = store;
  }

  /** Begins to record; returns a function that ends this. */
  watch(): () => void {
    return this.#store.subscribe((state, before) => {
      const beganMs = performance.now();
      this.#take(state, before);
      this.spend(performance.now() - beganMs);
    });
  }

  /** The state that the figures tell: of the moment at which they were frozen, or of now. */
  get shown(): ViewerState {
    return this.#frozen ?? this.#store.getState();
  }

  /** Another number whenever the frames have changed. */
  get revision(): number {
    return this.#revision;
  }

  /** Oldest first. */
  frames(side: Side): readonly FrameStatistics[] {
    return this.#frames[side].toArray();
  }

  /** CPU time of the calls to the engine between each of the last frames and the one before, ms. */
  get renderMs(): readonly number[] {
    return this.#renderMs.toArray();
  }

  /** CPU time that the figures themselves took of each frame, ms. */
  get ownMs(): readonly number[] {
    return this.#ownMs.toArray();
  }

  /** The figures have taken so much CPU time, ms. */
  spend(elapsedMs: number): void {
    this.#spentMs += elapsedMs;
  }

  #take(state: ViewerState, before: ViewerState): void {
    if (state.isHudFrozen !== before.isHudFrozen) this.#frozen = state.isHudFrozen ? state : null;
    if (this.#frozen) return;
    // Frames of a moving scene, and files that are moved, are of the same scene.
    if (state.scene?.contentKey !== before.scene?.contentKey) this.#clear();
    if (state.rightStatistics === null && before.rightStatistics) this.#frames.right.clear();
    if (state.rightStatistics !== before.rightStatistics) this.#add('right', state.rightStatistics);
    if (state.lastRender !== before.lastRender) this.#calledMs += state.lastRender?.elapsedMs ?? 0;
    if (state.statistics === before.statistics) return;
    this.#add('left', state.statistics);
    this.#renderMs.push(this.#calledMs);
    this.#ownMs.push(this.#spentMs);
    this.#calledMs = 0;
    this.#spentMs = 0;
  }

  #add(side: Side, statistics: FrameStatistics | null): void {
    this.#revision++;
    if (statistics) this.#frames[side].push(statistics);
  }

  /** Another scene's frames say nothing about this one's. */
  #clear(): void {
    this.#revision++;
    this.#frames.left.clear();
    this.#frames.right.clear();
    this.#renderMs.clear();
  }
}

const recorders = new WeakMap<ViewerStore, FrameRecorder>();

/** The recorder of a store, from the first time on that figures are shown: hidden ones come back. */
export function recorderOf(store: ViewerStore): FrameRecorder {
  let recorder = recorders.get(store);
  if (!recorder) {
    recorder = new FrameRecorder(store);
    recorder.watch();
    recorders.set(store, recorder);
  }
  return recorder;
}
