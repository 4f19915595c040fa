import { shownBytes } from '@websplatter/kit/shown-pixels';
import { useEffect, useMemo, useRef } from 'react';
import { useStore } from 'zustand';
import { frameOfView } from '../engine/show/frame-of-view.ts';
import type { PanelProps } from '../engine/viewer.ts';
import type { KeptView } from '../state/saved-view.ts';
import { SavedViews } from './saved-views.ts';

const WIDTH_PX = 144;
const MAX_HEIGHT_PX = 144;
const JPEG_QUALITY = 0.8;

/**
 * Draws a thumbnail of a view, without panels; returns a base64 JPEG, or null if there is no frame.
 */
export async function drawThumbnail({ store, viewer }: PanelProps, seen: KeptView): Promise<string | null> {
  const shown = viewer.shownFrame;
  if (!shown) return null;
  const { centred: frame, engine, isFlipped } = shown;
  const scale = Math.min(WIDTH_PX / frame.widthPx, MAX_HEIGHT_PX / frame.heightPx);
  const widthPx = Math.max(1, Math.round(frame.widthPx * scale));
  const heightPx = Math.max(1, Math.round(frame.heightPx * scale));
  const { accuracy } = store.getState();
  const small = frameOfView(frame, isFlipped, viewer.camera, seen, { widthPx, heightPx });
  const canvas = Object.assign(document.createElement('canvas'), { width: widthPx, height: heightPx });
  // A separate view: other images that are read back need not wait.
  const view = engine.createView();
  try {
    view.render({ ...small, accuracy });
    const { data } = await view.readPixels();
    const [red, green, blue] = frame.background ?? [0, 0, 0];
    const pixels = shownBytes(data, [red, green, blue]);
    canvas.getContext('2d')?.putImageData(new ImageData(pixels, widthPx, heightPx), 0, 0);
  } finally {
    view.destroy();
  }
  return canvas.toDataURL('image/jpeg', JPEG_QUALITY).split(',')[1];
}

/** Draws a base64 JPEG on `canvas`; does nothing if the text is invalid. */
async function showThumbnail(canvas: HTMLCanvasElement, base64: string): Promise<void> {
  try {
    const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
    // An image element with a data URL would need permission in the content security policy.
    const image = await createImageBitmap(new Blob([bytes], { type: 'image/jpeg' }));
    Object.assign(canvas, { width: image.width, height: image.height });
    canvas.getContext('2d')?.drawImage(image, 0, 0);
    image.close();
  } catch {
    // A stored picture that is damaged leaves its view without a thumbnail.
    canvas.width = 1;
  }
}

/** A small image of a view; null while there is none. */
export function Thumbnail({ jpeg }: { jpeg: string | null }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (canvas.current) void showThumbnail(canvas.current, jpeg ?? '');
  }, [jpeg]);
  return <canvas ref={canvas} />;
}

/** The saved views of the scene; thumbnails that links lack are drawn meanwhile. */
export function useSavedViews({ store, viewer }: PanelProps): SavedViews {
  const views = useMemo(
    () =>
      new SavedViews({
        store,
        camera: viewer.camera,
        draw: (view) => drawThumbnail({ store, viewer }, view),
      }),
    [store, viewer],
  );
  const hasPicture = useStore(store, (state) => state.imageId > 0);
  const incomplete = useStore(store, ({ savedViews }) =>
    savedViews.find(({ thumbnail }) => thumbnail === null),
  );
  useEffect(() => {
    if (hasPicture && incomplete) void views.complete(incomplete);
  }, [views, hasPicture, incomplete]);
  return views;
}
