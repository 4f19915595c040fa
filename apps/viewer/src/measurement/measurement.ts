import { isSoftwareAdapter, WebSplatterError } from '@websplatter/core';
import type { MeasureProgress } from '@websplatter/core/measure';
import type { MeasuredPicture, MeasuredThing, ViewerStore } from '../state/store.ts';
import type { StandingPicture, Viewer } from '../viewer/viewer.ts';

export interface MeasurementOptions {
  readonly signal: AbortSignal;
  readonly onProgress: (progress: MeasureProgress) => void;
}

/**
 * Measures the picture that stands and tells the store how far it is. One thing at a time: two would slow each other down.
 */
export class Measurement {
  readonly #viewer: Viewer;
  readonly #store: ViewerStore;
  #running: AbortController | null = null;

  constructor(viewer: Viewer, store: ViewerStore) {
    this.#viewer = viewer;
    this.#store = store;
  }

  /** Ends what is measured of a scene that goes away; returns what stops that, and what is being measured with it. */
  watch(): () => void {
    const unsubscribe = this.#store.subscribe((state, before) => {
      if (state.scene !== before.scene || state.status !== before.status) this.stop();
    });
    return () => {
      unsubscribe();
      this.stop();
    };
  }

  /** @returns null where there is no picture, something is being measured already, or nothing came of it: the store says why. */
  async run<T>(
    of: MeasuredThing,
    work: (picture: StandingPicture, options: MeasurementOptions) => Promise<T>,
  ): Promise<(T & MeasuredPicture) | null> {
    const picture = this.#viewer.standing;
    if (!picture || this.#running) return null;
    const store = this.#store;
    const running = new AbortController();
    this.#running = running;
    const { signal } = running;
    const { pictureId } = store.getState();
    store.setState({ sweep: { of, done: 0, total: 1, label: 'Preparing' }, sweepProblem: null });
    try {
      const onProgress = (progress: MeasureProgress) => {
        if (!signal.aborted) store.setState({ sweep: { of, ...progress } });
      };
      const result = await work(picture, { signal, onProgress });
      const isSoftware = isSoftwareAdapter(picture.engine.device.adapterInfo);
      return signal.aborted ? null : { ...result, pictureId, isSoftware };
    } catch (error) {
      // The engine calls off what is measured for views that have gone on to show something else.
      if (signal.aborted || (error as Error).name === 'AbortError') return null;
      if (!(error instanceof WebSplatterError)) console.error(error);
      store.setState({ sweepProblem: { of, text: error instanceof Error ? error.message : String(error) } });
      return null;
    } finally {
      if (this.#running === running) {
        this.#running = null;
        store.setState({ sweep: null });
      }
    }
  }

  /** Calls off what is being measured. */
  stop(): void {
    this.#running?.abort();
    this.#running = null;
    if (this.#store.getState().sweep) this.#store.setState({ sweep: null });
  }
}
