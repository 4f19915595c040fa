import {
  type AccuracySettings,
  isSoftwareAdapter,
  type SplatEngine,
  WebSplatterError,
} from '@websplatter/core';
import type { AccuracyTable, MeasureAccuracyOptions } from '@websplatter/core/measure';
import type { ViewerState, ViewerStore } from './store.ts';
import type { StandingPicture, Viewer } from './viewer.ts';

/** A software rasteriser takes as long for a frame as a GPU for a hundred, and varies less. */
const SOFTWARE_FRAMES = 3;

type MeasureOptions = Pick<MeasureAccuracyOptions, 'signal' | 'onProgress'>;

/**
 * Measures what accuracy costs in the picture that stands, one measurement at a time, and tells the store. A wish is
 * measured as soon as it is made, and again for each scene that is opened.
 */
export class AccuracySweep {
  readonly #viewer: Viewer;
  readonly #store: ViewerStore;
  #running: AbortController | null = null;
  /** What was drawn before there was this wish in this scene: comes back where nothing is chosen. */
  #fallback: AccuracySettings;

  constructor(viewer: Viewer, store: ViewerStore) {
    this.#viewer = viewer;
    this.#store = store;
    this.#fallback = store.getState().accuracy;
  }

  /** Ends measurements whose scene goes away, and begins those that are wished for; returns what stops that. */
  watch(): () => void {
    const unsubscribe = this.#store.subscribe((state, before) => {
      const { scene, wish, status } = state;
      if (scene !== before.scene || wish !== before.wish || status !== before.status) {
        this.#fallback = before.accuracy;
        this.#stop();
      }
      if (lacksChoice(this.#store.getState())) void this.choose();
    });
    return () => {
      unsubscribe();
      this.#stop();
    };
  }

  /** Measures the present view: presets, settings one at a time away from the default, and promising combinations. */
  measure(): Promise<void> {
    return this.#run(async ({ engine, frame }, options) => {
      const { measureAccuracy } = await import('@websplatter/core/measure');
      const { camera, clouds, widthPx, heightPx } = frame;
      return measureAccuracy(engine, {
        clouds,
        cameras: [camera],
        widthPx,
        heightPx,
        ...(isSoftware(engine) && { frames: SOFTWARE_FRAMES, combinations: false }),
        ...options,
      });
    });
  }

  /** Measures what meets the wish, and draws with it. */
  choose(): Promise<void> {
    return this.#run(async (_, options) => (await this.#viewer.chooseAccuracy(options)).table);
  }

  /** What was found before stays; a wish that nothing was chosen for yet ends. */
  cancel(): void {
    this.#stop();
    this.#giveUp();
  }

  #stop(): void {
    this.#running?.abort();
    this.#running = null;
    if (this.#store.getState().sweep) this.#store.setState({ sweep: null });
  }

  #giveUp(): void {
    const { wish, choice } = this.#store.getState();
    if (wish && !choice) this.#viewer.setAccuracy(this.#fallback);
  }

  async #run(
    work: (picture: StandingPicture, options: MeasureOptions) => Promise<AccuracyTable>,
  ): Promise<void> {
    const picture = this.#viewer.standing;
    if (!picture || this.#running) return;
    const store = this.#store;
    const running = new AbortController();
    this.#running = running;
    const { signal } = running;
    const { pictureId } = store.getState();
    store.setState({ sweep: { done: 0, total: 1, label: 'Preparing' }, sweepProblem: '' });
    try {
      const table = await work(picture, {
        signal,
        onProgress: (sweep) => {
          if (!signal.aborted) store.setState({ sweep });
        },
      });
      if (signal.aborted) return;
      store.setState({ measured: { table, pictureId, isSoftware: isSoftware(picture.engine) } });
    } catch (error) {
      if (signal.aborted) return;
      if (!(error instanceof WebSplatterError)) console.error(error);
      store.setState({ sweepProblem: error instanceof Error ? error.message : String(error) });
      this.#giveUp();
    } finally {
      if (this.#running === running) {
        this.#running = null;
        store.setState({ sweep: null });
      }
    }
  }
}

/** Whether there is a picture and a wish, but nothing was chosen for it. */
function lacksChoice({ wish, choice, status, scene, isIdle }: ViewerState): boolean {
  return wish !== null && choice === null && status === 'running' && scene !== null && isIdle;
}

function isSoftware({ device }: SplatEngine): boolean {
  return isSoftwareAdapter(device.adapterInfo);
}
