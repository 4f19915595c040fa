import type { DrawnPeer } from './drawn-peer.ts';
import type { Picture } from './protocol.ts';
import type { WebGpuWatch } from './watch-webgpu.ts';

/** Draws a frame and takes the canvas's pixels. */
export async function canvasPicture(drawn: DrawnPeer, webgpu: WebGpuWatch, camera: string): Promise<Picture> {
  const png = await (await takenFrame(drawn, webgpu)).png;
  const { width: widthPx, height: heightPx, data } = await pixelsOf(png, 1);
  const pngBase64 = base64(new Uint8Array(await png.arrayBuffer()));
  return { camera, widthPx, heightPx, rgbaBase64: base64(data), pngBase64 };
}

/**
 * Draws a frame to its end and takes its picture, which is encoded while the page goes on. It is
 * taken in the task that drew it: the browser clears a canvas that it has shown. By `toBlob`, since
 * `drawImage` finds WebGPU's canvases empty where Chromium has a GPU but no display.
 */
export async function takenFrame(
  { peer, canvas, drawer, completion }: DrawnPeer,
  webgpu: WebGpuWatch,
): Promise<{ readonly png: Promise<Blob> }> {
  let taken: Promise<Blob | null> | undefined;
  const take = () => {
    taken = new Promise((resolve) => canvas.toBlob(resolve, 'image/png'));
  };
  if (drawer.api === 'webgpu') {
    let isDue = false;
    // Takes one picture per task, after all of its submissions. The frame's last task has the whole picture.
    webgpu.afterSubmit = () => {
      if (isDue) return;
      isDue = true;
      queueMicrotask(() => {
        isDue = false;
        take();
      });
    };
    await peer.draw();
    webgpu.afterSubmit = null;
  } else {
    await peer.draw();
    take();
  }
  await completion();
  return { png: encoded(taken) };
}

async function encoded(taken: Promise<Blob | null> | undefined): Promise<Blob> {
  const png = await taken;
  if (!png) throw new Error('The frame left no picture on the canvas.');
  return png;
}

/**
 * Decodes an image of `toBlob`, `shrink` times smaller, over black; encoding it once more would
 * wait for the page to be idle.
 */
export async function pixelsOf(png: Blob, shrink: number): Promise<ImageData> {
  const bitmap = await createImageBitmap(png);
  const [width, height] = [bitmap.width, bitmap.height].map((px) => Math.ceil(px / shrink));
  const context = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
  if (!context) throw new Error('This browser has no 2D context.');
  context.fillStyle = '#000';
  context.fillRect(0, 0, width, height);
  context.drawImage(bitmap, 0, 0, width, height);
  bitmap.close();
  return context.getImageData(0, 0, width, height);
}

function base64(bytes: Uint8Array | Uint8ClampedArray): string {
  const PIECE = 8192;
  let text = '';
  for (let at = 0; at < bytes.length; at += PIECE)
    text += String.fromCharCode(...bytes.subarray(at, at + PIECE));
  return btoa(text);
}
