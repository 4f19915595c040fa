import { ACCURACY_PRESETS } from '@websplatter/core';
import { isSameAccuracy } from '../formatting/accuracy-words.ts';
import type { ViewerStore } from '../state/store.ts';
import type { Viewer } from '../viewer/viewer.ts';
import type { ErrorMap } from './error-map.ts';
import type { ErrorMapRequest } from './error-map.worker.ts';

/**
 * Keeps the error map of the image on the screen, against `reference`, on `canvas`. The canvas is
 * hidden while the image moves, and comes back when a worker has compared both images. Returns a
 * function that stops this.
 */
export function showErrorMap(canvas: HTMLCanvasElement, viewer: Viewer, store: ViewerStore): () => void {
  const worker = new Worker(new URL('./error-map.worker.ts', import.meta.url), { type: 'module' });
  /** `restedFrames` of the image that was compared last or is being compared. */
  let comparedFrames = -1;
  let isBusy = false;
  let isStopped = false;

  const hide = () => {
    canvas.hidden = true;
    if (store.getState().errorFigures) store.setState({ errorFigures: null });
  };

  const show = ({ data, widthPx, heightPx, figures }: ErrorMap) => {
    canvas.width = widthPx;
    canvas.height = heightPx;
    canvas.getContext('2d')?.putImageData(new ImageData(data, widthPx, heightPx), 0, 0);
    canvas.hidden = false;
    store.setState({ errorFigures: figures });
  };

  const compare = async () => {
    const { accuracy } = store.getState();
    const reference = await viewer.readImage(ACCURACY_PRESETS.reference);
    const actual = isSameAccuracy(accuracy, ACCURACY_PRESETS.reference)
      ? reference
      : await viewer.readImage(accuracy);
    if (!reference || !actual || isStopped) return null;
    return askWorker(worker, { actual, reference });
  };

  const follow = async () => {
    const { isIdle, restedFrames } = store.getState();
    if (!isIdle || restedFrames !== comparedFrames) hide();
    if (!isIdle || restedFrames === comparedFrames || isBusy || isStopped) return;
    comparedFrames = restedFrames;
    isBusy = true;
    try {
      const map = await compare();
      const now = store.getState();
      if (map && !isStopped && now.isIdle && now.restedFrames === restedFrames) show(map);
    } catch (error) {
      // A lost device or a replaced scene ends the comparison too; the viewer reports both itself.
      if (!isStopped && store.getState().status === 'running') console.error(error);
    } finally {
      isBusy = false;
    }
    if (!isStopped && store.getState().restedFrames !== comparedFrames) void follow();
  };

  hide();
  void follow();
  const unsubscribe = store.subscribe((state, before) => {
    if (state.isIdle !== before.isIdle || state.restedFrames !== before.restedFrames) void follow();
  });
  return () => {
    isStopped = true;
    unsubscribe();
    worker.terminate();
    store.setState({ errorFigures: null });
  };
}

function askWorker(worker: Worker, request: ErrorMapRequest): Promise<ErrorMap> {
  return new Promise((resolve, reject) => {
    worker.onmessage = ({ data }: MessageEvent<ErrorMap>) => resolve(data);
    worker.onerror = (event) => reject(new Error(event.message || 'The worker could not be started.'));
    worker.postMessage(request);
  });
}
