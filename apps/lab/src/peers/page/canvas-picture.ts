import type { DrawnPeer } from './drawn-peer.ts';
import type { Picture } from './protocol.ts';
import type { WebGpuWatch } from './watch-webgpu.ts';

/**
 * Draws a frame and takes what the canvas then holds. The picture is taken in the task that drew
 * it: the browser clears a WebGL canvas that it has shown, and in headless Chromium `drawImage`
 * finds a WebGPU canvas empty later.
 */
export async function canvasPicture(drawn: DrawnPeer, webgpu: WebGpuWatch, camera: string): Promise<Picture> {
  const { canvas } = drawn;
  let taken: Promise<Blob | null> | undefined;
  const take = () => {
    taken = new Promise((resolve) => canvas.toBlob(resolve, 'image/png'));
  };
  if (drawn.drawer.api === 'webgpu') {
    // The last submission of the frame stays.
    webgpu.afterSubmit = take;
    await drawn.frame();
    webgpu.afterSubmit = null;
  } else {
    await drawn.peer.draw();
    take();
  }
  const blob = await taken;
  if (!blob) throw new Error('The frame left no picture on the canvas.');
  return { camera, ...(await pixelsOf(blob)) };
}

/** Decodes an image of `toBlob`; encoding it once more would wait for the page to be idle. */
async function pixelsOf(png: Blob): Promise<Omit<Picture, 'camera'>> {
  const bitmap = await createImageBitmap(png);
  const { width: widthPx, height: heightPx } = bitmap;
  const context = new OffscreenCanvas(widthPx, heightPx).getContext('2d', { willReadFrequently: true });
  if (!context) throw new Error('This browser has no 2D context.');
  context.fillStyle = '#000';
  context.fillRect(0, 0, widthPx, heightPx);
  context.drawImage(bitmap, 0, 0);
  const { data } = context.getImageData(0, 0, widthPx, heightPx);
  const pngBase64 = base64(new Uint8Array(await png.arrayBuffer()));
  return { widthPx, heightPx, rgbaBase64: base64(data), pngBase64 };
}

function base64(bytes: Uint8Array | Uint8ClampedArray): string {
  const PIECE = 8192;
  let text = '';
  for (let at = 0; at < bytes.length; at += PIECE)
    text += String.fromCharCode(...bytes.subarray(at, at + PIECE));
  return btoa(text);
}
