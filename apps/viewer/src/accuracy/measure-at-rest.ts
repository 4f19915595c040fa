import { isSoftwareAdapter, WebSplatterError } from '@websplatter/core';
import type { MeasureProgress } from '@websplatter/core/measure';
import { shallow } from 'zustand/vanilla/shallow';
import type { ShownFrame, Viewer } from '../engine/viewer.ts';
import type { MeasuredImage, MeasuredThing } from '../state/measured.ts';
import type { ViewerStore } from '../state/store.ts';
import { describeMeasured } from '../ui/accuracy-words.ts';

export interface RestMeasurementOptions {
  readonly image: MeasuredImage;
  readonly signal: AbortSignal;
  readonly onProgress: (progress: MeasureProgress) => void;
}

/**
 * Runs measurements of the current frame and writes their progress to the store. One at a time: two
 * would slow each other down.
 */
export class RestMeasurement {
  readonly #viewer: Viewer;
  readonly #store: ViewerStore;
  #running: AbortController | null = null;

  constructor(viewer: Viewer, store: ViewerStore) {
    this.#viewer = viewer;
    this.#store = store;
  }

  /** Whether the current frame was drawn by a CPU; false if there is none. */
  get isOnSoftware(): boolean {
    const shown = this.#viewer.shownFrame;
    return shown !== null && isSoftwareAdapter(shown.engine.device.adapterInfo);
  }

  /** Cancels a measurement when its scene or device is gone. Returns a function that stops both. */
  watch(): () => void {
    const unsubscribe = this.#store.subscribe(
      ({ scene, status }) => [scene, status],
      () => this.stop(),
      { equalityFn: shallow },
    );
    return () => {
      unsubscribe();
      this.stop();
    };
  }

  /**
   * Runs `work` on the frame at rest; does nothing if there is none or another measurement runs.
   * Failures are written to the store.
   */
  async run(
    of: MeasuredThing,
    work: (shown: ShownFrame, options: RestMeasurementOptions) => Promise<void>,
  ): Promise<void> {
    if (!this.#viewer.shownFrame || this.#running) return;
    const store = this.#store;
    const running = new AbortController();
    this.#running = running;
    const { signal } = running;
    store.setState({ measuring: { of, done: 0, total: 1, label: 'Preparing' }, failedMeasurement: null });
    try {
      await this.#rest(signal);
      const shown = this.#viewer.shownFrame;
      if (!shown) return;
      const { imageId } = store.getState();
      const isSoftware = this.isOnSoftware;
      const onProgress = (progress: MeasureProgress) => {
        if (!signal.aborted) store.setState({ measuring: { of, ...progress, label: plainLabel(progress) } });
      };
      await work(shown, { image: { imageId, isSoftware }, signal, onProgress });
    } catch (error) {
      // The engine cancels measurements for views that have drawn something else.
      if (signal.aborted || (error as Error).name === 'AbortError') return;
      if (!(error instanceof WebSplatterError)) console.error(error);
      const text = error instanceof Error ? error.message : String(error);
      store.setState({ failedMeasurement: { of, text } });
    } finally {
      if (this.#running === running) {
        this.#running = null;
        store.setState({ measuring: null });
      }
    }
  }

  /** Resolves when the picture is at rest: results for an earlier one would be out of date. */
  #rest(signal: AbortSignal): Promise<void> {
    return new Promise((resolve, reject) => {
      const look = () => {
        if (!this.#viewer.isAtRest) return;
        unsubscribe();
        resolve();
      };
      const unsubscribe = this.#store.subscribe(look);
      signal.addEventListener('abort', () => {
        unsubscribe();
        reject(signal.reason);
      });
      look();
    });
  }

  /** Cancels the running measurement. */
  stop(): void {
    this.#running?.abort();
    this.#running = null;
    if (this.#store.getState().measuring) this.#store.setState({ measuring: null });
  }
}

/** The label of a step, with settings in plain words. */
function plainLabel({ label, point }: MeasureProgress): string {
  return point ? label.replace(point.name, describeMeasured(point)) : label;
}
