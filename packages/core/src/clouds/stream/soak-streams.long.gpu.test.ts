// Proves: after 2,500 frames of a camera that wanders and jumps, in a budget that holds a part of the
// scene, a streamed SOG, a .rad and a .bricks show the same, bit for bit, as in a fresh engine. Frames
// are planned, and parts placed and evicted on the GPU, but only the last pictures are drawn:
// SwiftShader takes 30 to 70 ms for each.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { expect } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import type { Vec3 } from '../../data/math/mat4.ts';
import { nextTask } from '../../data/turns.ts';
import { write } from '../../io/formats/bricks/write-bricks.ts';
import type { SplatSource } from '../../io/sources/splat-source.ts';
import { FIXED_RASTERIZER } from '../../testing/fixed-rasterizer.ts';
import { drawComplete, lookFrom } from '../../testing/look-at-streams.ts';
import { nestedNodes, radBytes } from '../../testing/rad-fixture.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { sightFrom } from '../../testing/sight-from.ts';
import { droppedFiles } from '../../testing/sog-fixture.ts';
import { streamedSog, streamedSogFiles } from '../../testing/streamed-sog-fixture.ts';
import { poolBytes } from '../bricks/brick-pool.ts';
import { chunkBytes } from './chunk-pages.ts';

const FRAMES = 2500;
/** Frames between two waits for the device. */
const AT_ONCE = 8;
/** Share of frames after which the camera is elsewhere, and not a step further. */
const JUMPS = 0.06;
const STEP = 0.05;
/** Distances from the origin. */
const [NEAREST, FARTHEST] = [0.8, 2.5];
/** Errors of views, in radians. */
const ERRORS = [0.001, 0.01, 0.1];

const VIEWS = [
  { detail: { maxErrorPx: 0.2 }, position: [0, 0, 1.2] },
  { detail: { maxErrorPx: 2 }, position: [1.2, 0.4, 0.2] },
  { detail: 'full', position: [-1, -0.6, 1] },
] as const;

interface Soaked {
  readonly source: SplatSource;
  readonly budgetBytes: number;
}

const SCENES: Readonly<Record<string, () => Promise<Soaked>>> = {
  'streamed SOG': async () => {
    const leafCount = 16;
    const set = randomSplats({ count: 240 * leafCount, seed: 2, shDegree: 0, logScales: [-5, -3] });
    const sog = await streamedSog({ set, filesOfLevel: [leafCount, 4, 1], leafCount });
    return { source: droppedFiles(streamedSogFiles(sog)), budgetBytes: (leafCount + 10) * chunkBytes(0) };
  },
  '.rad': async () => {
    const bytes = radBytes(nestedNodes(16_000, 1000), { degree: 1, chunkSize: 1000 });
    return { source: new File([bytes], 'a.rad'), budgetBytes: 48 * chunkBytes(1) };
  },
  '.bricks': async () => {
    const set = randomSplats({ count: 24_000, seed: 2, shDegree: 0, logScales: [-7, -4] });
    const bytes = (await write(set, {})) as Uint8Array<ArrayBuffer>;
    return { source: new File([bytes], 'a.bricks'), budgetBytes: poolBytes(0, { lowest: 2, upper: 3 }) };
  },
};

/** Positions of a camera that wanders around the origin, and jumps now and then. */
function* walk(random: () => number): Generator<Vec3, never, void> {
  const anywhere = () => [0, 1, 2].map(() => random() - 0.5) as [number, number, number];
  let position = anywhere();
  for (;;) {
    const step = anywhere();
    const next = random() < JUMPS ? step : position.map((value, axis) => value + 2 * STEP * step[axis]);
    const length = Math.hypot(...next);
    const distance = Math.min(FARTHEST, Math.max(NEAREST, length));
    position = next.map((value) => (value * distance) / length) as typeof position;
    yield position;
  }
}

/**
 * @fault Devices and engines: 2,500 frames of a streamed SOG, .rad or .bricks that its budget does not
 *   hold, around which a camera wanders and jumps
 * @consequence the budget holds, and every picture equals that of a fresh engine, bit for bit
 */
for (const [name, make] of Object.entries(SCENES))
  gpuTest(`${name} after ${FRAMES} frames is drawn as in a fresh engine`, async () => {
    const device = await shareTestDevice();
    const { source, budgetBytes } = await make();
    const start = async () => {
      const engine = await SplatEngine.create({ device, accuracy: FIXED_RASTERIZER });
      return { engine, cloud: await engine.load(source, { budgetBytes }) };
    };
    const { engine, cloud } = await start();
    const stream = cloud.stream!;
    const random = seededRandom(3);
    const positions = walk(random);
    const view = {};
    let [radians, version, replaced] = [ERRORS[0], cloud.version, 0];
    for (let frame = 1; frame <= FRAMES; frame++) {
      if (random() < JUMPS) radians = ERRORS[Math.floor(ERRORS.length * random())];
      stream.setSights(view, [sightFrom(positions.next().value, [0, 0, 0], radians)], async () => {});
      stream.onFrame();
      await nextTask();
      if (frame % AT_ONCE === 0) await device.queue.onSubmittedWorkDone();
      const { residentBricks, mostBricks, error } = stream.report();
      expect(error).toBeNull();
      expect(residentBricks).toBeLessThanOrEqual(mostBricks);
      expect(cloud.bytes).toBeLessThanOrEqual(budgetBytes);
      replaced += Number(cloud.version !== version && residentBricks === mostBricks);
      version = cloud.version;
    }
    expect(replaced).toBeGreaterThan(FRAMES / 100);
    stream.leave(view);
    const pictures: Float32Array[] = [];
    for (const { detail, position } of VIEWS) {
      const camera = lookFrom(position);
      const { data } = await drawComplete(engine, cloud, { detail }, camera);
      const fresh = await start();
      expect(data).toEqual((await drawComplete(fresh.engine, fresh.cloud, { detail }, camera)).data);
      expect(data.some((value) => value > 0.1)).toBe(true);
      for (const other of pictures) expect(data).not.toEqual(other);
      pictures.push(data);
      fresh.engine.destroy();
    }
    engine.destroy();
  });
