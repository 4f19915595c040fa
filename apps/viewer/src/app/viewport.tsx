import { useEffect, useRef } from 'react';
import { useStore } from 'zustand';
import type { Viewer } from '../engine/viewer.ts';
import type { ViewerStore } from '../state/store.ts';
import { isGpuLost } from '../state/viewer-state.ts';

/** The canvas: while it is mounted the viewer draws to it. */
export function Viewport({ store, viewer }: { store: ViewerStore; viewer: Viewer }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const title = useStore(store, (state) => state.scene?.title);
  const isLost = useStore(store, isGpuLost);
  useEffect(() => (canvas.current ? viewer.attach(canvas.current) : undefined), [viewer]);
  // A page lay over the canvas and had the keyboard.
  useEffect(() => (isLost ? () => canvas.current?.focus() : undefined), [isLost]);
  return (
    // biome-ignore lint/a11y/noInteractiveElementToNoninteractiveRole: it gives the page the keys.
    <canvas
      ref={canvas}
      className="viewport"
      data-testid="viewport"
      tabIndex={0}
      role="application"
      aria-label={`3D view${title ? ` of ${title}` : ''}. Arrow keys turn it, plus and minus zoom, question mark lists all keys.`}
    />
  );
}
