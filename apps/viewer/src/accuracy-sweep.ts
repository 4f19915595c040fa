import { isSoftwareAdapter, WebSplatterError } from '@websplatter/core';
import type {
  AccuracyChoice,
  AccuracyTable,
  AccuracyWish,
  MeasureAccuracyOptions,
} from '@websplatter/core/measure';
import type { MeasuredAccuracy, ViewerStore } from './store.ts';
import type { StandingPicture, Viewer } from './viewer.ts';

/** Views that a wish has to be met from: what is seen now, and others around it. */
const WISH_VIEWS = 8;
/** A software rasteriser takes as long for a frame as a GPU for a hundred, and varies less. */
const SOFTWARE_FRAMES = 3;

type Measure = typeof import('@websplatter/core/measure');
type Result = { readonly table: AccuracyTable; readonly choice: AccuracyChoice | null };

/** Measures what accuracy costs in the picture that stands, one measurement at a time, and tells the store. */
export class AccuracySweep {
  readonly #viewer: Viewer;
  readonly #store: ViewerStore;
  #running: AbortController | null = null;

  constructor(viewer: Viewer, store: ViewerStore) {
    this.#viewer = viewer;
    this.#store = store;
  }

  /** Ends measurements whose scene goes away; returns what stops that, and what is being measured with it. */
  watch(): () => void {
    const unsubscribe = this.#store.subscribe((state, before) => {
      if (state.scene !== before.scene || state.status !== before.status) this.cancel();
    });
    return () => {
      unsubscribe();
      this.cancel();
    };
  }

  /** Measures the present view: presets, settings one at a time away from the chosen ones, and promising combinations. */
  measure(): Promise<void> {
    return this.#run(async ({ measureAccuracy }, { engine }, options) => {
      return { table: await measureAccuracy(engine, options), choice: null };
    });
  }

  /** Measures, and draws with what meets `wish`, or comes closest, from then on. */
  async choose(wish: AccuracyWish): Promise<void> {
    const previous = this.#store.getState().measured?.choice ?? undefined;
    await this.#run(async ({ chooseAccuracy, sampleCameras }, picture, options) => {
      const { engine, frame, bounds } = picture;
      const cameras = isSoftware(picture) ? [frame.camera] : sampleCameras(frame.camera, bounds, WISH_VIEWS);
      const choice = await chooseAccuracy(engine, wish, { ...options, cameras, base: 'balanced', previous });
      return { table: choice.table, choice };
    });
  }

  cancel(): void {
    this.#running?.abort();
    this.#running = null;
    if (this.#store.getState().sweep) this.#store.setState({ sweep: null });
  }

  async #run(
    work: (measure: Measure, picture: StandingPicture, options: MeasureAccuracyOptions) => Promise<Result>,
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
      const measure = await import('@websplatter/core/measure');
      const { camera, clouds, widthPx, heightPx } = picture.frame;
      const result = await work(measure, picture, {
        clouds,
        cameras: [camera],
        widthPx,
        heightPx,
        ...(isSoftware(picture) && { frames: SOFTWARE_FRAMES, combinations: false }),
        signal,
        onProgress: (sweep) => {
          if (!signal.aborted) store.setState({ sweep });
        },
      });
      if (signal.aborted) return;
      const measured: MeasuredAccuracy = { ...result, pictureId, isSoftware: isSoftware(picture) };
      store.setState({ measured });
      if (result.choice) this.#viewer.setAccuracy(result.choice.settings);
    } catch (error) {
      if (signal.aborted) return;
      if (!(error instanceof WebSplatterError)) console.error(error);
      store.setState({ sweepProblem: error instanceof Error ? error.message : String(error) });
    } finally {
      if (this.#running === running) {
        this.#running = null;
        store.setState({ sweep: null });
      }
    }
  }
}

function isSoftware({ engine }: StandingPicture): boolean {
  return isSoftwareAdapter(engine.device.adapterInfo);
}
