import { nextTask } from '../src/peers/adapter.ts';
import { playCanvasScene } from './playcanvas-scene.js';

/** Told by the names of files. */
export const formats = ['ply', 'compressed-ply', 'sog'];

const MAX_FRAMES_TO_LOAD = 600;

/**
 * `?exact` draws all that the engine leaves out by default: small and faint splats, and colours of
 * small turns.
 *
 * @param renderer one of the engine's constants GSPLAT_RENDERER_…; by default its own choice
 * @type {(pc: any, renderer?: string) => import('../src/peers/adapter.ts').LoadPeer}
 */
export const playCanvasPeer =
  (pc, renderer) =>
  async ({ canvas, url, fileName, options }) => {
    const { app, load, isReady, peer } = await playCanvasScene(pc, canvas);
    if (renderer) app.scene.gsplat.renderer = pc[renderer];
    if (options.has('exact'))
      Object.assign(app.scene.gsplat, { minPixelSize: 0, minContribution: 0, colorUpdateAngle: 0 });
    await load(url, fileName);
    for (let frame = 0; !isReady() && frame < MAX_FRAMES_TO_LOAD; frame++) {
      peer.draw();
      await nextTask();
    }
    if (!isReady()) throw new Error(`PlayCanvas was not ready after ${MAX_FRAMES_TO_LOAD} frames.`);
    const chosen = options.has('exact') ? 'nothing left out' : 'defaults';
    return { note: renderer ? `${renderer}, ${chosen}` : chosen, ...peer };
  };
