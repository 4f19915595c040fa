import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterEach, beforeAll, expect, vi } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import type { LeafScene } from '../../data/bricks/leaf-scene.ts';
import { openLeaves } from '../../io/formats/sog/open-leaves.ts';
import { knownSource } from '../../io/sources/known-source.ts';
import { FIXED_RASTERIZER } from '../../testing/fixed-rasterizer.ts';
import {
  byLevel,
  drawComplete,
  expectOneLevel,
  expectShown,
  lookFrom,
  streamContext,
} from '../../testing/look-at-streams.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { sightFrom } from '../../testing/sight-from.ts';
import { droppedFiles } from '../../testing/sog-fixture.ts';
import { streamedSog, streamedSogFiles } from '../../testing/streamed-sog-fixture.ts';
import { chunkBytes } from '../stream/chunk-pages.ts';
import { streamLeaves } from './stream-leaves.ts';

let device: GPUDevice;
beforeAll(async () => {
  device = await shareTestDevice();
});
afterEach(() => vi.restoreAllMocks());

const LEAVES = 4;
/** Views of all leaves at their finest level, of some at the next, and of all at the coarsest. */
const [NEAR, MIDDLE, FAR] = [
  [lookFrom([0, 0, 2]), { maxErrorPx: 0.01 }] as const,
  [lookFrom([0, 0, 6]), { maxErrorPx: 6 }] as const,
  [lookFrom([0, 0, 30]), { maxErrorPx: 50 }] as const,
];

gpuTest('levels that were drawn before are drawn again without a fetch, while there is room', async () => {
  const set = randomSplats({ count: 1200, seed: 2, shDegree: 0, logScales: [-4, -3] });
  const sog = await streamedSog({ set, filesOfLevel: [LEAVES, 2, 1], leafCount: LEAVES });
  const engine = await SplatEngine.create({ device, accuracy: FIXED_RASTERIZER });
  const opened = (await openLeaves(knownSource(droppedFiles(streamedSogFiles(sog, 'scene/')))))!;
  let reads = 0;
  const scene: LeafScene = byLevel({
    ...opened,
    read: (...args) => {
      reads++;
      return opened.read(...args);
    },
  });
  // Room for the coarsest level of each leaf and the finest, of two chunks.
  const budgetBytes = (LEAVES + 2 * LEAVES + 4) * chunkBytes(scene.shDegree);
  const cloud = await streamLeaves(streamContext(engine.device), scene, { budgetBytes }, {});
  const look = async ([camera, detail]: typeof NEAR | typeof MIDDLE | typeof FAR, when: string) => {
    const { data, report } = await drawComplete(engine, cloud, { detail }, camera);
    expect(report, when).toMatchObject({ isComplete: true, missing: 0 });
    return { data, reads, cut: expectOneLevel(scene, await expectShown(engine.device, cloud), when) };
  };
  const first = await look(NEAR, 'near');
  expect(first.cut).toBe('0,10,20,30');
  expect((await look(FAR, 'far')).cut).toBe('2,12,22,32');
  expect(await look(NEAR, 'near again')).toEqual(first);
  const middle = await look(MIDDLE, 'in the middle');
  expect(middle.cut).toMatch(/1/);
  expect(middle.reads).toBeGreaterThan(first.reads);
  const { reads: readsInAll, ...last } = await look(NEAR, 'in the end');
  expect(first).toMatchObject(last);
  // Only what had to make room has been fetched again.
  expect(readsInAll - middle.reads).toBeGreaterThan(0);
  expect(readsInAll - middle.reads).toBeLessThan(LEAVES);
  cloud.destroy();
  engine.destroy();
});

gpuTest('what a view turns past is fetched once it rests, what it keeps in sight at once', async () => {
  const set = randomSplats({ count: 4000, seed: 2, shDegree: 0, logScales: [-4, -3] });
  const sog = await streamedSog({ set, filesOfLevel: [8, 1], leafCount: 8 });
  const engine = await SplatEngine.create({ device, accuracy: FIXED_RASTERIZER });
  const scene = (await openLeaves(knownSource(droppedFiles(streamedSogFiles(sog, 'scene/')))))!;
  let nowMs = 1000;
  vi.spyOn(performance, 'now').mockImplementation(() => nowMs);
  // The scene is in sight at angles of about π.
  for (const { radiansPerS, from, isPast } of [
    { radiansPerS: 8, from: 0.2, isPast: true },
    { radiansPerS: 0.05, from: Math.PI, isPast: false },
  ]) {
    let reads = 0;
    const counted: LeafScene = {
      ...scene,
      end: () => {},
      read: (...args) => {
        reads++;
        return scene.read(...args);
      },
    };
    const cloud = await streamLeaves(streamContext(engine.device), counted, {}, {});
    const stream = cloud.stream!;
    const coarse = reads;
    const view = {};
    let angle = from;
    const turn = async (frames: number, radians: number) => {
      for (let frame = 0; frame < frames; frame++) {
        nowMs += 16;
        angle += 0.016 * radiansPerS;
        const target = [Math.sin(angle), 0, 6 + Math.cos(angle)] as const;
        stream.setSights(view, [sightFrom([0, 0, 6], target, radians)], async () => {});
        await Promise.resolve();
      }
    };
    await turn(20, 100);
    expect(reads).toBe(coarse);
    await turn(6, 1e-6);
    expect(reads > coarse).toBe(!isPast);
    expect(stream.complete).not.toBeNull();
    expect(stream.report().isComplete).toBe(false);
    const readsLater = () => {
      nowMs += 1000;
      return reads;
    };
    await expect.poll(readsLater).toBeGreaterThan(coarse);
    cloud.destroy();
  }
  scene.end();
  engine.destroy();
});
