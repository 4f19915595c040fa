import { useEffect, useRef } from 'react';
import type { PanelProps } from '../viewer/panel-props.ts';
import { showErrorMap } from './error-map-overlay.ts';

/** The error map over the viewer's canvas. */
export function ErrorMapImage({ store, viewer }: PanelProps) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(
    () => (canvas.current ? showErrorMap(canvas.current, viewer, store) : undefined),
    [store, viewer],
  );
  return <canvas ref={canvas} className="over-picture" data-testid="error-map" />;
}
