import { ACCURACY_PRESETS } from '@websplatter/core';
import { useEffect, useRef } from 'react';
import { askWorker } from '../engine/ask-worker.ts';
import { drawAtRest } from '../engine/draw-at-rest.ts';
import type { PanelProps } from '../engine/panel-props.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { Drawn } from '../state/comparison.ts';
import type { ViewerStore } from '../state/store.ts';
import type { ErrorMap } from './error-map.ts';
import type { ErrorMapRequest } from './error-map.worker.ts';
import { mapped } from './mapped.ts';

/** The error map over the viewer's canvas. */
export function ErrorMapImage({ store, viewer }: PanelProps) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(
    () => (canvas.current ? showErrorMap(canvas.current, viewer, store) : undefined),
    [store, viewer],
  );
  return <canvas ref={canvas} className="over-picture" data-testid="error-map" />;
}

const REFERENCE: Drawn = { accuracy: ACCURACY_PRESETS.reference, detail: 'full' };

/**
 * Keeps the error map of the image at rest, against `reference` in full detail, on `canvas`: a
 * worker compares both images. Returns a function that stops this.
 */
function showErrorMap(canvas: HTMLCanvasElement, viewer: Viewer, store: ViewerStore): () => void {
  const worker = new Worker(new URL('./error-map.worker.ts', import.meta.url), { type: 'module' });
  const stop = drawAtRest<ErrorMap>(canvas, viewer, store, {
    asked: ({ restedFrames }) => String(restedFrames),
    async make() {
      const { accuracy } = mapped(store.getState());
      const reference = await viewer.readImage(REFERENCE);
      const actual = await viewer.readImage({ accuracy });
      if (!reference || !actual) return null;
      return askWorker<ErrorMap>(worker, { actual, reference } satisfies ErrorMapRequest);
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
