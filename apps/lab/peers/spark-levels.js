// Spark's levels of detail without its renderer: its own worker builds and cuts them, in a thread
// of Node instead of a browser's. Floats as Spark holds them by `extSplats`.
import { on } from 'node:events';
import { readFile } from 'node:fs/promises';
import { Worker as Thread } from 'node:worker_threads';
import { ExtSplats, utils } from '@sparkjsdev/spark';
import { cameraPosition } from '@websplatter/core';
import { timeSpread } from '@websplatter/core/measure';
import { splatsFromArrays } from '@websplatter/core/own-data';
import { EVERY_SPLAT, stackedOpacity, storedOpacity } from '../src/peers/levels/stacked-opacity.ts';

/** What Spark's worker finds in a browser. Its log has the time of building. */
const BROWSER = `
  const { parentPort } = require('node:worker_threads');
  globalThis.self = globalThis;
  console.log = (log) => parentPort.postMessage({ log });
  for (const name of ['postMessage', 'addEventListener', 'removeEventListener'])
    self[name] = parentPort[name].bind(parentPort);
`;

/** The newest worker. */
let worker;
let log = '';

/** Begins a thread with the program that Spark gives as a `data:` address. */
class BrowserWorker extends Thread {
  constructor(address) {
    const program = decodeURIComponent(address.slice(address.indexOf(',') + 1));
    super(BROWSER + program, { eval: true });
    this.on('message', (data) => {
      if (data.log) log = data.log;
      else this.onmessage({ data });
    });
    worker = this;
  }

  addEventListener() {}
}

/** Asks Spark's worker, as its renderer does. */
async function ask(name, args) {
  const messages = on(worker, 'message', { close: ['exit'] });
  worker.postMessage({ id: name, name, args });
  for await (const [{ id, result, error }] of messages) {
    if (error) throw error;
    if (id === name) return result;
  }
  throw new Error(`Spark's worker ended before it answered ${name}.`);
}

/** Defaults of `SparkRenderer`. No limit of its own to how small nodes are: the budget decides. */
const DEFAULTS = { lodScale: 1, behindFoveate: 0.2, coneFov0: 90, coneFov: 120, coneFoveate: 0.4 };
/** Arrays of harmonics, each with four words of a node. */
const BANDS = ['sh1', 'sh2', 'sh3a', 'sh3b'];
const SH_C0 = 0.28209479177387814;

/** Spark's levels, by each of its ways to build them, one after the other. */
export async function* sparkLevels(engine, { count, shDegree }, plyFile) {
  for (const [builder, lod] of Object.entries({ 'tiny-lod': true, 'bhatt-lod': 'quality' })) {
    globalThis.Worker = BrowserWorker;
    const splats = new ExtSplats({ fileBytes: await readFile(plyFile), fileType: 'ply', lod });
    const { lodSplats } = await splats.initialized;
    // Ours would take it for a browser's.
    delete globalThis.Worker;
    const { numSplats, extra } = lodSplats;
    const { lodId } = await ask('initLodTree', { numSplats, lodTree: extra.lodTree });

    const chosenNodes = async (camera, share) => {
      const scene = { instanceId: 'scene', lodId, viewToObjectCols: viewToWorld(camera), ...DEFAULTS };
      const maxSplats = Math.round(share * count);
      const limits = { maxSplats, pixelScaleLimit: 0, traverseMode: 'standard' };
      const { keyIndices } = await ask('traverseLodTrees', { ...limits, instances: { scene } });
      return keyIndices.scene.indices.subarray(0, keyIndices.scene.numSplats);
    };
    yield {
      name: `Spark ${builder}`,
      buildMs: [Number(/\(([\d.]+) ms\)/.exec(log)[1])],
      async choose(camera, share) {
        const nodes = await chosenNodes(camera, share);
        const cloud = engine.add(splatsOf(lodSplats, nodes, shDegree));
        await cloud.makeLevels();
        const instance = { cloud, effects: [stackedOpacity()] };
        return { instance, detail: EVERY_SPLAT, end: () => cloud.destroy() };
      },
      async choiceMs(cameras, share) {
        const times = [];
        for (const camera of cameras) {
          const startedMs = performance.now();
          await chosenNodes(camera, share);
          times.push(performance.now() - startedMs);
        }
        return timeSpread(times).median;
      },
    };
    await ask('disposeLodTree', { lodId });
  }
}

/** Axes and position of a camera, column by column. */
function viewToWorld({ viewMatrix: m }) {
  const axes = [0, 1, 2].flatMap((axis) => [m[axis], m[4 + axis], m[8 + axis], 0]);
  return [...axes, ...cameraPosition(m), 1];
}

function splatsOf(lodSplats, nodes, shDegree) {
  const coefficients = (shDegree + 1) ** 2;
  const positions = new Float64Array(3 * nodes.length);
  const scales = new Float32Array(3 * nodes.length);
  const rotations = new Float32Array(4 * nodes.length);
  const opacities = new Float64Array(nodes.length);
  const sh = new Float32Array(3 * coefficients * nodes.length);
  nodes.forEach((node, i) => {
    const splat = lodSplats.getSplat(node);
    splat.center.toArray(positions, 3 * i);
    splat.scales.toArray(scales, 3 * i);
    splat.quaternion.toArray(rotations, 4 * i);
    opacities[i] = storedOpacity(splat.opacity);
    splat.color
      .addScalar(-0.5)
      .multiplyScalar(1 / SH_C0)
      .toArray(sh, 3 * coefficients * i);
    for (let k = 0; k < coefficients - 1; k++) {
      const word = lodSplats.extra[BANDS[k >> 2]][4 * node + (k & 3)];
      utils.decodeExtRgb(word).toArray(sh, 3 * (coefficients * i + k + 1));
    }
  });
  return splatsFromArrays({ positions, scales, rotations, opacities, sh });
}
