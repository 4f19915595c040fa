import { useEffect, useRef } from 'react';
import type { PanelProps } from '../engine/viewer.ts';
import { showMap } from './show-map.ts';

/** The map of a view mode, over the picture. */
export function ModeMap({ store, viewer }: PanelProps) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => (canvas.current ? showMap(canvas.current, viewer, store) : undefined), [store, viewer]);
  return <canvas ref={canvas} className="over-picture mode-map" data-testid="mode-map" />;
}
