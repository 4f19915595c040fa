// main.js of antimatter15/splat, unmodified, as a script of the page. It drives itself by frames of
// the browser, which are stepped from here, and takes view and focal length from variables of its
// own.
import mainScript from 'peer-source/main.js?raw';
import { colmapView, nextTask } from '../src/peers/adapter.ts';

export const formats = ['ply', 'splat'];

const ROW_BYTES = 32;
/** The script's own test of whether an order suits a view, by the directions of both. */
const GOOD_ENOUGH = 0.01;
/** Elements that the script writes to. */
const ELEMENTS = ['fps', 'camid', 'progress', 'spinner', 'message'];

/** Messages to and from the script's worker, which it keeps to itself. */
const watched = { view: null, order: null, orders: 0, splats: Number.POSITIVE_INFINITY };
const PlainWorker = globalThis.Worker;
globalThis.Worker = class extends PlainWorker {
  constructor(...args) {
    super(...args);
    this.addEventListener('message', ({ data: { depthIndex, buffer, ...order } }) => {
      if (buffer) watched.splats = buffer.byteLength / ROW_BYTES;
      if (!depthIndex) return;
      watched.order = order;
      watched.orders++;
    });
  }

  postMessage(message, ...rest) {
    const { view, buffer, vertexCount } = message;
    if (view) watched.view = view;
    // While a .splat arrives, the worker gets its arrived part, in a buffer for all of it.
    if (vertexCount * ROW_BYTES === buffer?.byteLength) watched.splats = vertexCount;
    super.postMessage(message, ...rest);
  }
};

function isOrdered() {
  const { order, view, splats } = watched;
  if (!order || order.vertexCount < splats) return false;
  const directions = [2, 6, 10].reduce((sum, i) => sum + view[i] * order.viewProj[i], 0);
  return Math.abs(directions - 1) < GOOD_ENOUGH || view.every((value, i) => value === order.viewProj[i]);
}

/** @type {import('../src/peers/adapter.ts').LoadPeer} */
export default async function loadAntimatter15({ canvas, url }) {
  canvas.id = 'canvas';
  const hidden = Object.assign(document.createElement('div'), { hidden: true });
  hidden.innerHTML = ELEMENTS.map((id) => `<div id="${id}"></div>`).join('');
  document.body.append(hidden);
  let nextFrame = null;
  globalThis.requestAnimationFrame = (callback) => {
    nextFrame = callback;
    return 0;
  };
  const step = () => {
    const { textContent } = document.getElementById('message');
    if (textContent) throw new Error(textContent);
    const frame = nextFrame;
    nextFrame = null;
    frame?.(performance.now());
  };
  // A view in the address ends the tour that it begins with.
  const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  const address = encodeURIComponent(new URL(url, location.href).href);
  history.replaceState(null, '', `?url=${address}#${encodeURIComponent(JSON.stringify(identity))}`);
  const controls = 'window.peer = { setView: (view) => { viewMatrix = view; }, camera: () => camera };';
  document.head.append(
    Object.assign(document.createElement('script'), { textContent: `${mainScript}\n${controls}` }),
  );
  const { setView, camera } = window.peer;
  do {
    step();
    await nextTask();
  } while (!isOrdered());

  return {
    note: 'base colours only: it knows no spherical harmonics; depths from 0.2 to 200; sorts again for turns of more than 8°',
    setCamera: (by) => {
      setView(colmapView(by));
      const focalPx = canvas.height / (2 * Math.tan((by.fovYDegrees * Math.PI) / 360));
      if (camera().fx === focalPx) return;
      Object.assign(camera(), { fx: focalPx, fy: focalPx });
      window.dispatchEvent(new Event('resize'));
    },
    draw: step,
    // Only drawing tells the worker of a view.
    order: async () => {
      step();
      while (!isOrdered()) await nextTask();
    },
    orders: () => watched.orders,
    figures: () => ({ splats: watched.order.vertexCount }),
  };
}
