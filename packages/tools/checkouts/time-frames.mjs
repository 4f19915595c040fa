// Times frames of one checkout, as bench-render.mjs asks over IPC: `node time-frames.mjs OPTIONS`, which are JSON.
import { cameraAt, MODELS } from './cameras.mjs';
import { openCheckout } from './open-checkout.mjs';
import { randomPly } from './random-ply.mjs';

/**
 * So few, and in so few pixels, that the GPU's work stays small, which a software adapter does on the same cores: with 300
 * splats per cloud SwiftShader computed for a second per frame of 50 clouds, with 40 for a fifth of that.
 */
const SPLATS = { count: 40, shDegree: 1, logScales: [-7, -6] };
const SIZE = { widthPx: 16, heightPx: 16 };

const { folder, dawn } = JSON.parse(process.argv[2]);
const checkout = await openCheckout({ folder, dawn });
const { core, device } = checkout;
const engine = await core.SplatEngine.create({ device });
const behind = device.createTexture({
  size: [SIZE.widthPx, SIZE.heightPx],
  format: 'rgba16float',
  usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
});
/** By name of the bench: what draws one frame and returns how long the call took, ms. */
const benches = new Map();
let framesDrawn = 0;

process.on('message', ({ bench, cloudCount, frames, isWarmUp }) => {
  timeFrames(bench, cloudCount, frames, isWarmUp).then(
    (timesMs) => process.send({ timesMs }),
    (error) => process.send({ error: error.message }),
  );
});
process.send({ adapter: checkout.adapterLabel, node: process.versions.node });

async function timeFrames(bench, cloudCount, frames, isWarmUp) {
  const name = `${bench} ${cloudCount}`;
  if (!benches.has(name)) benches.set(name, await BENCHES[bench](await placeClouds(cloudCount)));
  const draw = benches.get(name);
  const timesMs = [];
  for (let i = 0; i < frames; i++) {
    timesMs.push(draw(nextCamera()));
    // The next call is to find the queue empty, whatever the GPU takes.
    await device.queue.onSubmittedWorkDone();
    // Shaders are compiled in the first frames.
    if (isWarmUp) await checkout.compiled();
  }
  const errors = await checkout.takeErrors();
  if (errors.length > 0) throw new Error(errors.join('; '));
  return timesMs;
}

const BENCHES = {
  async 'view.render'(clouds) {
    const view = engine.createView();
    return (camera) => {
      const startMs = performance.now();
      view.render({ camera, clouds, ...SIZE });
      return performance.now() - startMs;
    };
  },
  async 'EmbeddedView.prepare'(clouds) {
    const view = engine.createEmbeddedView();
    return (camera) => {
      const startMs = performance.now();
      const isPrepared = view.prepare({ camera, clouds, ...SIZE });
      const elapsedMs = performance.now() - startMs;
      if (!isPrepared) return elapsedMs;
      // A host draws what it prepares.
      const encoder = device.createCommandEncoder();
      view.draw(encoder, { color: behind, depth: null, xPx: 0, yPx: 0 });
      device.queue.submit([encoder.finish()]);
      return elapsedMs;
    };
  },
};

/** Every second cloud has effects and stands elsewhere. */
async function placeClouds(count) {
  const { clip, tint } = checkout.effects;
  const clouds = [];
  for (let i = 0; i < count; i++) {
    const ply = randomPly({ ...SPLATS, seed: i + 1 });
    const cloud = await engine.load(ply, { name: `cloud ${i}` });
    if (i % 2 === 0) {
      clouds.push({ cloud });
      continue;
    }
    const volumes = [{ shape: 'sphere', center: [0, 0, 0], radius: 1 + 0.01 * i }];
    const effects = [tint([1, 0.5 + 0.01 * i, 0.5]), clip({ volumes })];
    const modelMatrix = Float64Array.from(MODELS.sheared);
    modelMatrix[12] = 0.02 * i;
    clouds.push({ cloud, modelMatrix, effects });
  }
  return clouds;
}

/** Never where it was before, so that every frame is planned, culled, recorded and submitted. */
function nextCamera() {
  framesDrawn++;
  const turn = 0.3 * Math.sin(0.01 * framesDrawn);
  return cameraAt(core, 1, { moved: turn + 1e-6 * framesDrawn, turned: turn });
}
