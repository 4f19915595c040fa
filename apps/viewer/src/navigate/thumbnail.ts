import { frameOfView } from '../engine/frame-of-view.ts';
import type { PanelProps } from '../engine/panel-props.ts';
import { shownBytes } from '../engine/shown-pixels.ts';
import type { KeptView } from '../state/saved-view.ts';

const WIDTH_PX = 144;
const MAX_HEIGHT_PX = 144;
const JPEG_QUALITY = 0.8;

/** Draws a view of the scene, small, without panels; returns a base64 JPEG, or null for no frame. */
export async function drawThumbnail({ store, viewer }: PanelProps, seen: KeptView): Promise<string | null> {
  const shown = viewer.shownFrame;
  if (!shown) return null;
  const { centred: frame, engine } = shown;
  const scale = Math.min(WIDTH_PX / frame.widthPx, MAX_HEIGHT_PX / frame.heightPx);
  const widthPx = Math.max(1, Math.round(frame.widthPx * scale));
  const heightPx = Math.max(1, Math.round(frame.heightPx * scale));
  const { accuracy, isFlipped } = store.getState();
  const small = frameOfView(frame, isFlipped, viewer.camera, seen, { widthPx, heightPx });
  const canvas = Object.assign(document.createElement('canvas'), { width: widthPx, height: heightPx });
  // A view of its own, so that other images are not in the way.
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

/** Shows a JPEG image, base64, on `canvas`; nothing for any other text. */
export async function showThumbnail(canvas: HTMLCanvasElement, base64: string): Promise<void> {
  try {
    const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
    // An image element with a data address would need a permission of the content security policy.
    const image = await createImageBitmap(new Blob([bytes], { type: 'image/jpeg' }));
    Object.assign(canvas, { width: image.width, height: image.height });
    canvas.getContext('2d')?.drawImage(image, 0, 0);
    image.close();
  } catch {
    canvas.width = 1;
  }
}
