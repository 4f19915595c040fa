// `npm run bench:eyes`: time of both eyes' frames, each with an order of its own, and with one that the first eye finds for
// both. The two ways take turns in one run, with a camera that moves: compare the ratios.
import os from 'node:os';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { describeCheckout } from './checkouts/checkout.mjs';
import { medianOf, stop, wholeNumber } from './checkouts/forked-timer.mjs';
import { openCheckout } from './checkouts/open-checkout.mjs';
import { ensureInstalled } from './setup.mjs';

const USAGE = `npm run bench:eyes -- [OPTION…]
  --splats N,N    sizes of the synthetic scene; default 100000,1000000
  --size WxH      pixels of an eye; default 1680x1760
  --frames N      frames per round; default 60
  --rounds N      rounds; default 7
  --rasterizer R  auto, tiles or quads; default auto
  --dawn FILE     the dawn.node of npm's webgpu, for folders without node_modules`;

const EYE_DISTANCE = 0.064;

const { counts, widthPx, heightPx, frames, rounds, rasterizer, dawn } = readOptions();
const ACCURACY = { preset: 'balanced', rasterizer };
const folder = fileURLToPath(new URL('../..', import.meta.url));
if (!dawn) {
  ensureInstalled();
  const { build } = await import('./build.mjs');
  await build().catch((error) => stop(error.message));
}
const { core, device, scenes, adapterLabel, compiled, takeErrors } = await openCheckout({ folder, dawn });
console.log(`${os.cpus()[0].model}, Node ${process.versions.node}, ${adapterLabel}`);
console.log(
  `${describeCheckout({ folder })}; ${rounds} rounds of ${frames} frames of two ${widthPx}×${heightPx} eyes`,
);
console.log('Time per frame of both eyes, ms, by the wall clock over a round: median (least to most)');

const behind = device.createTexture({
  size: [widthPx, heightPx],
  format: 'rgba16float',
  usage: GPUTextureUsage.TEXTURE_BINDING,
});
for (const splats of counts) await measure(splats).catch((error) => stop(error.message));
process.exit();

async function measure(splats) {
  const engine = await core.SplatEngine.create({ device });
  const cloud = await engine.load(scenes.syntheticPly({ splats }), { name: 'synthetic' });
  const ways = { 'two orders': newEyes(engine), 'one order': newEyes(engine) };
  const times = Object.fromEntries(Object.keys(ways).map((way) => [way, []]));
  let frame = 0;
  for (let round = -1; round < rounds; round++) {
    for (const [way, eyes] of Object.entries(ways)) {
      const isWarmUp = round < 0;
      const startMs = performance.now();
      for (let i = 0; i < frames; i++) {
        drawBoth(eyes, cloud, camerasAt(frame++), way === 'one order');
        // Shaders are compiled, room is made, and rasterisers are compared.
        if (isWarmUp) await compiled();
        if (isWarmUp) await device.queue.onSubmittedWorkDone();
      }
      await device.queue.onSubmittedWorkDone();
      if (!isWarmUp) times[way].push((performance.now() - startMs) / frames);
    }
  }
  console.log(`\n${splats} splats`);
  const [first] = Object.values(times).map(medianOf);
  for (const [way, timesMs] of Object.entries(times)) {
    const [left, right] = ways[way].map(
      (view) => `${view.statistics.visibleSplats} by ${view.rasterizer.rasterizer}`,
    );
    const sorted = timesMs.toSorted((a, b) => a - b);
    const median = medianOf(timesMs);
    console.log(
      `${way.padEnd(11)} ×${(median / first).toFixed(3)}  ${median.toFixed(3)} (${sorted[0].toFixed(3)} to ` +
        `${sorted.at(-1).toFixed(3)})  visible ${left}, ${right}`,
    );
  }
  const errors = await takeErrors();
  engine.destroy();
  if (errors.length > 0) throw new Error(errors.join('; '));
}

function newEyes(engine) {
  return [engine.createEmbeddedView(), engine.createEmbeddedView()];
}

/** Draws a frame of both eyes, once shaders are there. */
function drawBoth([left, right], cloud, [leftCamera, rightCamera], isShared) {
  const shared = { clouds: [{ cloud }], widthPx, heightPx, accuracy: ACCURACY };
  const isReady = [
    left.prepare({ ...shared, camera: leftCamera, ...(isShared && { beside: [rightCamera] }) }),
    right.prepare({ ...shared, camera: rightCamera, ...(isShared && { orderOf: left }) }),
  ];
  if (isReady.includes(false)) return;
  const encoder = device.createCommandEncoder();
  for (const view of [left, right]) view.draw(encoder, { color: behind, depth: null, xPx: 0, yPx: 0 });
  device.queue.submit([encoder.finish()]);
}

/** Both eyes of a head that turns about the scene's middle, with image planes that are shifted as those of headsets are. */
function camerasAt(frame) {
  const { position, target, up, fovYDegrees, near, far } = scenes.syntheticCamera;
  const angle = 0.002 * frame;
  const [x, z] = [position[0] - target[0], position[2] - target[2]];
  const camera = core.perspectiveCamera({
    position: [
      target[0] + Math.cos(angle) * x + Math.sin(angle) * z,
      position[1],
      target[2] + Math.cos(angle) * z - Math.sin(angle) * x,
    ],
    target,
    up,
    fovYDegrees: Math.max(90, fovYDegrees),
    aspect: widthPx / heightPx,
    near,
    far,
  });
  return [-1, 1].map((side) => {
    const viewMatrix = Float64Array.from(camera.viewMatrix);
    const projectionMatrix = Float64Array.from(camera.projectionMatrix);
    viewMatrix[12] -= (side * EYE_DISTANCE) / 2;
    projectionMatrix[8] -= side * 0.1;
    return core.cameraFromMatrices(viewMatrix, projectionMatrix, { near, far });
  });
}

function readOptions() {
  try {
    const { values } = parseArgs({
      options: {
        splats: { type: 'string', default: '100000,1000000' },
        size: { type: 'string', default: '1680x1760' },
        frames: { type: 'string', default: '60' },
        rounds: { type: 'string', default: '7' },
        rasterizer: { type: 'string', default: 'auto' },
        dawn: { type: 'string' },
      },
    });
    const [widthPx, heightPx] = values.size.split('x').map((text) => wholeNumber('size', text));
    return {
      counts: values.splats.split(',').map((text) => wholeNumber('splats', text)),
      widthPx,
      heightPx,
      frames: wholeNumber('frames', values.frames),
      rounds: wholeNumber('rounds', values.rounds),
      rasterizer: values.rasterizer,
      dawn: values.dawn ?? null,
    };
  } catch (error) {
    return stop(`${error.message}\n\n${USAGE}`);
  }
}
