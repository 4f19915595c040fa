// The renderer of KeKsBoTer/web-splat, which web-splat/build.sh compiles with what a page needs to drive it.

import init, { CanvasRenderer } from 'peer-source/lab/web_splat_peer.js';
import { cameraAxes } from '../src/peers/adapter.ts';

export const formats = ['ply'];

/** @type {import('../src/peers/adapter.ts').LoadPeer} */
export default async function loadWebSplat({ canvas, url }) {
  await init();
  const bytes = new Uint8Array(await (await fetch(url)).arrayBuffer());
  const renderer = await CanvasRenderer.load(canvas, bytes);
  return {
    note: 'without its window; culls what has its middle outside of 1.2 times the image',
    setCamera: (by) => {
      const { right, down, forward } = cameraAxes(by);
      const rotation = [0, 1, 2].flatMap((i) => [right[i], down[i], forward[i]]);
      const halfHeight = Math.tan((by.fovYDegrees * Math.PI) / 360);
      const fovX = 2 * Math.atan((halfHeight * canvas.width) / canvas.height);
      const fovY = 2 * Math.atan(halfHeight);
      renderer.set_camera(by.position, rotation, fovX, fovY, by.near, by.far);
    },
    draw: () => renderer.render(),
    figures: () => ({ splats: renderer.splats() }),
  };
}
