import { LogLevel, RenderMode, SceneFormat, SceneRevealMode, Viewer } from '@mkkellogg/gaussian-splats-3d';
import { nextTask } from '../src/peers/adapter.ts';
import { threeWebGl } from './three-webgl.js';

export const formats = ['ply', 'compressed-ply', 'spz 1', 'spz 2', 'splat', 'ksplat'];

const SCENE_FORMATS = {
  ply: SceneFormat.Ply,
  spz: SceneFormat.Spz,
  splat: SceneFormat.Splat,
  ksplat: SceneFormat.KSplat,
};

/** The most that the library draws. */
const SH_DEGREE = 2;

/** @type {import('../src/peers/adapter.ts').LoadPeer} */
export default async function loadMkkellogg({ canvas, url, fileName }) {
  const { renderer, camera, setCamera } = threeWebGl(canvas);
  const viewer = new Viewer({
    renderer,
    camera,
    rootElement: canvas.parentElement,
    selfDrivenMode: false,
    useBuiltInControls: false,
    ignoreDevicePixelRatio: true,
    sphericalHarmonicsDegree: SH_DEGREE,
    sceneRevealMode: SceneRevealMode.Instant,
    sharedMemoryForWorkers: crossOriginIsolated,
    renderMode: RenderMode.Always,
    logLevel: LogLevel.None,
  });
  let orders = 0;
  const runSplatSort = viewer.runSplatSort.bind(viewer);
  viewer.runSplatSort = (...args) => {
    const wasRunning = viewer.sortRunning;
    const run = runSplatSort(...args);
    if (!wasRunning && viewer.sortRunning) orders++;
    return run;
  };
  await viewer.addSplatScene(url, {
    format: SCENE_FORMATS[fileName.replace(/^.*\./, '').toLowerCase()],
    showLoadingUI: false,
    progressiveLoad: false,
    splatAlphaRemovalThreshold: 1,
  });
  while (!viewer.splatRenderReady) await nextTask();

  const idle = async () => {
    while (viewer.sortRunning) await nextTask();
  };
  const viewOf = () => camera.matrixWorld.elements.join();
  let orderedView = '';
  return {
    note: `spherical harmonics of degree ${SH_DEGREE} at most, otherwise defaults`,
    setCamera,
    draw: () => {
      // update() may sort for this view, or for a part of it.
      if (viewOf() !== orderedView) orderedView = '';
      viewer.update();
      viewer.render();
    },
    // One full sort by this view; update() would first sort a part.
    order: async () => {
      if (viewOf() === orderedView) return;
      await idle();
      await viewer.runSplatSort(true, true);
      await idle();
      orderedView = viewOf();
    },
    orders: () => orders,
    figures: () => ({ drawnSplats: viewer.splatRenderCount, splats: viewer.splatMesh.getSplatCount() }),
  };
}
