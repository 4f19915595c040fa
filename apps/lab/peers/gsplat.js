import * as SPLAT from 'gsplat';
import { cameraAxes, nextTask } from '../src/peers/adapter.ts';

export const formats = ['ply', 'splat'];

/** The worker rests after this many times its usual time without an answer to an earlier view. */
const REST = 2;
const MIN_REST_MS = 20;

/** Counts answers of the library's own worker, which it keeps to itself. */
let orders = 0;
const PlainWorker = globalThis.Worker;
globalThis.Worker = class extends PlainWorker {
  constructor(...args) {
    super(...args);
    this.addEventListener('message', ({ data }) => {
      if (data?.depthIndex?.length) orders++;
    });
  }
};

/** @type {import('../src/peers/adapter.ts').LoadPeer} */
export default async function loadGsplat({ canvas, url, fileName }) {
  const { width, height } = canvas;
  const scene = new SPLAT.Scene();
  const camera = new SPLAT.Camera();
  // Without passes: one of the defaults fades the splats in.
  const renderer = new SPLAT.WebGLRenderer(canvas, []);
  renderer.setSize(width, height);
  const loader = /\.ply$/i.test(fileName) ? SPLAT.PLYLoader : SPLAT.Loader;
  const splat = await loader.LoadAsync(url, scene);

  let isPrepared = false;
  let isResting = true;
  let sortMs = 0;
  let view = '';
  let drawnView = '';
  let orderedView = '';

  const draw = () => {
    if (drawnView !== view) isResting = false;
    if (orderedView !== view) orderedView = '';
    drawnView = view;
    renderer.render(scene, camera);
  };
  // The first frame sets the focal length for good: it must not come before the first camera.
  const prepare = async () => {
    const isComplete = () => {
      const { renderData, depthIndex } = renderer.renderProgram;
      const { updating, dataChanged, needsRebuild } = renderData;
      return depthIndex.length >= splat.data.vertexCount && !updating && !dataChanged && !needsRebuild;
    };
    do {
      draw();
      await nextTask();
    } while (!isComplete());
    isPrepared = true;
  };
  const rest = async () => {
    let seen = -1;
    while (seen !== orders) {
      seen = orders;
      await new Promise((resolve) => setTimeout(resolve, REST * sortMs + MIN_REST_MS));
    }
    isResting = true;
  };
  return {
    note: 'base colours only: it knows no spherical harmonics; no passes',
    setCamera: (by) => {
      const { right, down, forward } = cameraAxes(by);
      const rows = [0, 1, 2].flatMap((axis) => [right[axis], down[axis], forward[axis]]);
      camera.position = new SPLAT.Vector3(...by.position);
      camera.rotation = SPLAT.Quaternion.FromMatrix3(new SPLAT.Matrix3(...rows));
      const focalPx = height / (2 * Math.tan((by.fovYDegrees * Math.PI) / 360));
      Object.assign(camera.data, { fx: focalPx, fy: focalPx, near: by.near, far: by.far });
      camera.update();
      view = JSON.stringify(by);
    },
    draw,
    // Drawing posts the view to the worker. After a rest, its next order is for this view.
    order: async () => {
      if (orderedView === view) return;
      if (!isPrepared) await prepare();
      else if (!isResting) await rest();
      if (drawnView !== view) {
        const before = orders;
        const startedMs = performance.now();
        draw();
        while (orders === before) await nextTask();
        sortMs = performance.now() - startedMs;
        isResting = true;
      }
      orderedView = view;
    },
    orders: () => orders,
  };
}
