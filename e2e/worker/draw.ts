// The worker's part of the recipe "In a worker".
import { perspectiveCamera, SplatEngine, type SplatView } from '@websplatter/core';

export interface Scene {
  readonly canvas: OffscreenCanvas;
  readonly src: string;
  readonly widthPx: number;
  readonly heightPx: number;
}

addEventListener('message', async ({ data }: MessageEvent<Scene>) => {
  const { canvas, src, widthPx, heightPx } = data;
  const engine = await SplatEngine.create();
  const view: SplatView = engine.createView({ canvas });
  const cloud = await engine.load(src);
  const camera = perspectiveCamera({
    position: [1, 2, 5],
    target: [1, 1, 0],
    fovYDegrees: 50,
    aspect: widthPx / heightPx,
  });
  view.render({ camera, clouds: [{ cloud }], widthPx, heightPx });
  await view.whenComplete();
  postMessage('drawn');
});
