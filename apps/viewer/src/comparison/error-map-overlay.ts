import { ACCURACY_PRESETS } from '@websplatter/core';
import { drawAtRest } from '../drawing/draw-at-rest.ts';
import { isSameAccuracy } from '../formatting/accuracy-words.ts';
import type { Drawn } from '../state/comparison.ts';
import type { ViewerStore } from '../state/store.ts';
import type { Viewer } from '../viewer/viewer.ts';
import type { ErrorMap } from './error-map.ts';
import type { ErrorMapRequest } from './error-map.worker.ts';

const REFERENCE: Drawn = { accuracy: ACCURACY_PRESETS.reference, detail: 'full' };

/**
 * Keeps the error map of the image at rest, against `reference` in full detail, on `canvas`: a
 * worker compares both images. Returns a function that stops this.
 */
export function showErrorMap(canvas: HTMLCanvasElement, viewer: Viewer, store: ViewerStore): () => void {
  const worker = new Worker(new URL('./error-map.worker.ts', import.meta.url), { type: 'module' });
  const stop = drawAtRest<ErrorMap>(canvas, viewer, store, {
    asked: ({ restedFrames }) => String(restedFrames),
    async make() {
      const { accuracy, detail } = store.getState();
      const reference = await viewer.readImage(REFERENCE);
      const isReference = detail === 'full' && isSameAccuracy(accuracy, REFERENCE.accuracy);
      const actual = isReference ? reference : await viewer.readImage({ accuracy });
      if (!reference || !actual) return null;
      return askWorker(worker, { actual, reference });
    },
    onShow(map) {
      const errorFigures = map?.figures ?? null;
      if (errorFigures !== store.getState().errorFigures) store.setState({ errorFigures });
    },
  });
  return () => {
    stop();
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
