// The renderer of MarcusAndreasSvensson/gaussian-splatting-webgpu from a clone with its packages, without its interface.
import { Camera } from 'peer-source/src/splatting-web/camera.ts';
import { PackedGaussians } from 'peer-source/src/splatting-web/ply.ts';
import { Renderer } from 'peer-source/src/splatting-web/renderer.ts';
import { colmapView } from '../src/peers/adapter.ts';

export const formats = ['ply'];

const TILE_PX = 16;

/** @type {import('../src/peers/adapter.ts').LoadPeer} */
export default async function loadGaussianSplattingWebGpu({ canvas, url, camera: first }) {
  const { width, height } = canvas;
  // Frames are drawn when the bench asks for them alone.
  globalThis.requestAnimationFrame = () => 0;
  const cameraOf = (by) => {
    const view = new Float32Array(colmapView(by));
    const focalPx = height / (2 * Math.tan((by.fovYDegrees * Math.PI) / 360));
    const depths = by.far / (by.far - by.near);
    const scales = [(2 * focalPx) / width, (2 * focalPx) / height];
    const projection = [scales[0], 0, 0, 0, 0, scales[1], 0, 0, 0, 0, depths, 1, 0, 0, -by.near * depths, 0];
    return new Camera(height, width, view, new Float32Array(projection), focalPx, focalPx, 1);
  };
  let camera = cameraOf(first);
  const gaussians = new PackedGaussians(await (await fetch(url)).arrayBuffer());
  const context = await Renderer.requestContext(gaussians);
  const movement = { isDirty: () => true, getCamera: () => camera };
  const renderer = new Renderer(canvas, movement, gaussians, context, document.createElement('label'));
  // animate() does not wait for the frame that it draws.
  let drawn;
  const draw = renderer.draw.bind(renderer);
  renderer.draw = (next) => {
    drawn = draw(next);
  };
  const rows = Math.floor(height / TILE_PX) * TILE_PX;
  return {
    note: `sorts within the frame, and reads timestamps back at its end; draws ${rows} of ${height} rows, in whole tiles`,
    setCamera: (by) => {
      camera = cameraOf(by);
    },
    draw: async () => {
      await renderer.animate(true);
      await drawn;
    },
    figures: () => ({ splats: gaussians.numGaussians }),
  };
}
