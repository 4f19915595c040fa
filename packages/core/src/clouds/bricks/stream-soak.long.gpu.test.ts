import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { expect, vi } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import type { Brick, BrickScene } from '../../data/bricks/brick.ts';
import { brickSceneOf } from '../../data/bricks/make-bricks.ts';
import { perspectiveCamera } from '../../data/camera/camera.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { poolBytes } from './brick-pool.ts';

const FRAMES = 180;
/** Frames of a round about the scene, of which the first makes all buffers that any needs. */
const ROUND = 60;
/** Frames that are submitted before one is waited for. */
const AT_ONCE = 8;
const SIZE = { widthPx: 16, heightPx: 12 };
const detail = { maxErrorPx: 0.2 };

/** Close to the scene, so that each place needs other bricks. */
function cameraOf(frame: number) {
  const angle = (2 * Math.PI * frame) / ROUND;
  const position = [1.3 * Math.sin(angle), 0.2, 1.3 * Math.cos(angle)] as const;
  return perspectiveCamera({ position, target: [0, 0, 0], up: [0, 1, 0], fovYDegrees: 40, aspect: 4 / 3 });
}

gpuTest(
  `shows the same after ${FRAMES} frames as at first, and makes nothing for them`,
  async () => {
    const device = await shareTestDevice();
    const source = brickSceneOf(randomSplats({ count: 24_000, seed: 2, shDegree: 0, logScales: [-7, -4] }));
    let reads = 0;
    const bricks = new Map<number, Promise<Brick>>();
    const scene: BrickScene = {
      ...source,
      read: (address, signal) => {
        reads++;
        const brick = bricks.get(address.number) ?? source.read(address, signal);
        bricks.set(address.number, brick);
        return brick;
      },
    };
    const budgetBytes = poolBytes(scene.shDegree, { lowest: 2, upper: 3 });
    const start = async () => {
      const engine = await SplatEngine.create({
        device,
        accuracy: { rasterizer: 'quads', sortKeyBits: 16 },
        // Divided frames would leave out those that are asked for meanwhile.
        submissionBudgetMs: Number.POSITIVE_INFINITY,
      });
      const cloud = await engine.stream(scene, { budgetBytes });
      const view = engine.createView();
      return { engine, cloud, view, clouds: [{ cloud }] };
    };
    const { engine, view, clouds } = await start();
    const draw = async (frame: number) => {
      view.render({ camera: cameraOf(frame), clouds, ...SIZE, detail });
      if (frame % AT_ONCE === 0) await device.queue.onSubmittedWorkDone();
    };
    for (let frame = 0; frame < ROUND; frame++) await draw(frame);
    await view.whenComplete();
    const before = { memory: engine.memory(), counters: engine.counters(), reads };
    const made = (['createBuffer', 'createTexture'] as const).map((name) => vi.spyOn(device, name));
    for (let frame = ROUND; frame <= FRAMES; frame++) await draw(frame);
    await view.whenComplete();
    // Bricks came and went, each with parameters of its own for as long as it was merged.
    expect(reads - before.reads).toBeGreaterThan(10);
    const labels = made.flatMap(({ mock }) => mock.calls.map(([{ label }]) => label));
    expect(new Set(labels)).toEqual(new Set(['scene bricks parameters']));
    for (const spy of made) spy.mockRestore();
    const counters = engine.counters();
    expect(engine.memory().resources).toEqual(before.memory.resources);
    expect(counters).toMatchObject({
      pipelinesCompiled: before.counters.pipelinesCompiled,
      uploads: 1,
      uploadedBytes: before.counters.uploadedBytes,
    });
    expect(counters.framesDrawn - before.counters.framesDrawn).toBeGreaterThanOrEqual(FRAMES - ROUND);
    const { data } = await view.readPixels();
    const fresh = await start();
    fresh.view.render({ camera: cameraOf(FRAMES), clouds: fresh.clouds, ...SIZE, detail });
    await fresh.view.whenComplete();
    expect((await fresh.view.readPixels()).data).toEqual(data);
    expect(data.some((value) => value > 0.1)).toBe(true);
    for (const each of [engine, fresh.engine]) each.destroy();
  },
  900_000,
);
