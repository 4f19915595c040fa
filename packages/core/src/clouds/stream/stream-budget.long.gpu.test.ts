import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect, onTestFinished, vi } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import type { BrickScene } from '../../data/bricks/brick.ts';
import { brickSceneOf } from '../../data/bricks/make-bricks.ts';
import { perspectiveCamera } from '../../data/camera/camera.ts';
import { DestroyedError } from '../../data/errors.ts';
import { identity4, translated4 } from '../../data/math/mat4.ts';
import type { EngineOptions } from '../../engine.ts';
import { FIXED_RASTERIZER } from '../../testing/fixed-rasterizer.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { signalOf } from '../../testing/signal.ts';
import { droppedFiles } from '../../testing/sog-fixture.ts';
import { type StreamedSog, streamedSog, streamedSogFiles } from '../../testing/streamed-sog-fixture.ts';
import { poolBytes } from '../bricks/brick-pool.ts';
import type { SplatCloud } from '../splat-cloud.ts';
import { chunkBytes } from './chunk-pages.ts';

const REQUEST = {
  widthPx: 96,
  heightPx: 64,
  detail: { maxErrorPx: 0.2 },
  camera: perspectiveCamera({
    position: [0.2, 0.1, 1.4],
    target: [0, 0, 0],
    up: [0, 1, 0],
    fovYDegrees: 40,
    aspect: 1.5,
  }),
};

describe('scenes that share a budget', () => {
  let device: GPUDevice;
  let scenes: readonly BrickScene[];
  let sog: StreamedSog;
  /** Room for less than half of a scene. */
  const half = poolBytes(1, { lowest: 4, upper: 1 });
  beforeAll(async () => {
    device = await shareTestDevice();
    scenes = [2, 3].map((seed) => ({
      ...brickSceneOf(randomSplats({ count: 40_000, seed, shDegree: 1, logScales: [-7, -4] })),
      name: `scene ${seed}`,
    }));
    const set = randomSplats({ count: 30_000, seed: 4, shDegree: 1, logScales: [-6, -4] });
    sog = await streamedSog({ set, filesOfLevel: [4, 2, 1], leafCount: 12 });
  });

  async function start(options: Partial<EngineOptions> = {}) {
    const engine = await SplatEngine.create({ device, accuracy: FIXED_RASTERIZER, ...options });
    onTestFinished(() => engine.destroy());
    const drawn = async (...clouds: readonly SplatCloud[]) => {
      const view = engine.createView();
      const places = clouds.map((cloud, i) => ({
        cloud,
        modelMatrix: translated4(identity4(), [0.3 * i, 0, 0]),
      }));
      view.render({ ...REQUEST, clouds: places });
      await view.whenComplete();
      const { data } = await view.readPixels();
      view.destroy();
      return data;
    };
    return { engine, drawn };
  }

  /** Largest bytes of all that streams, of each moment at which a buffer is made. */
  function watched(engine: SplatEngine): () => number {
    let most = 0;
    const look = () => {
      const own = engine.memory().resources.filter(({ label }) => /^(?:scene|lod)/.test(label));
      const bytes = own.filter(({ label }) => !label.endsWith(' parameters')).map((each) => each.bytes);
      most = Math.max(
        most,
        bytes.reduce((sum, each) => sum + each, 0),
      );
      return most;
    };
    const make = device.createBuffer.bind(device);
    const spy = vi.spyOn(device, 'createBuffer').mockImplementation((descriptor) => {
      queueMicrotask(look);
      look();
      return make(descriptor);
    });
    onTestFinished(() => spy.mockRestore());
    return look;
  }

  gpuTest('show the best of their shares, and keep it as another comes and goes', async () => {
    const { engine, drawn } = await start({ streamBudgetBytes: 2 * half });
    const mostBytes = watched(engine);
    const reads = [0, 0];
    const counted = scenes.map((scene, i) => ({
      ...scene,
      read: (...request: Parameters<BrickScene['read']>) => {
        reads[i]++;
        return scene.read(...request);
      },
    }));
    const first = await engine.stream(counted[0]);
    const view = engine.createView();
    view.render({ ...REQUEST, clouds: [{ cloud: first }] });
    await view.whenComplete();
    const alone = (await view.readPixels()).data;
    const { residentBricks } = first.stream!.report();
    const fetched = reads[0];

    const second = await engine.stream(counted[1]);
    expect(first.bytes).toBeLessThanOrEqual(half);
    expect(first.stream!.report().residentBricks).toBeLessThan(residentBricks);
    await view.whenComplete();
    const shared = (await view.readPixels()).data;
    // Only what has no room any more has gone.
    expect(reads[0]).toBe(fetched);
    expect(first.stream!.report()).toMatchObject({ isComplete: true });
    const both = await drawn(first, second);
    expect(shared).not.toEqual(alone);

    const own = await start();
    const options = { budgetBytes: half };
    const ownClouds = [
      await own.engine.stream(scenes[0], options),
      await own.engine.stream(scenes[1], options),
    ];
    expect(await own.drawn(ownClouds[0])).toEqual(shared);
    expect(await own.drawn(...ownClouds)).toEqual(both);

    second.destroy();
    await expect.poll(() => first.bytes).toBeGreaterThan(1.5 * half);
    view.render({ ...REQUEST, clouds: [{ cloud: first }] });
    await view.whenComplete();
    expect((await view.readPixels()).data).toEqual(alone);
    expect(mostBytes()).toBeLessThanOrEqual(2 * half);
    expect(mostBytes()).toBeGreaterThan(1.8 * half);
  });

  gpuTest('share it with streamed SOG, which keeps what it has', async () => {
    const load = (engine: SplatEngine, budgetBytes?: number) =>
      engine.load(droppedFiles(streamedSogFiles(sog, 'scene/')), { budgetBytes });
    const ofSog = 100 * chunkBytes(1);
    const { engine, drawn } = await start({ streamBudgetBytes: 2 * ofSog });
    const mostBytes = watched(engine);
    const cloud = await load(engine);
    const alone = await drawn(cloud);
    const other = await engine.stream(scenes[0]);
    expect(cloud.bytes).toBeLessThanOrEqual(ofSog);
    expect(cloud.stream!.report().residentBricks).toBeLessThanOrEqual(100);
    const shared = await drawn(cloud);
    const own = await start();
    expect(await own.drawn(await load(own.engine, ofSog))).toEqual(shared);
    expect(shared).not.toEqual(alone);
    other.destroy();
    await expect.poll(() => cloud.stream!.report().mostBricks).toBeGreaterThan(120);
    expect(await drawn(cloud)).toEqual(alone);
    expect(cloud.bytes).toBeGreaterThan(1.2 * ofSog);
    expect(mostBytes()).toBeLessThanOrEqual(2 * ofSog);
  });

  gpuTest('may end at any time, and leave nothing behind', async () => {
    const { engine, drawn } = await start({ streamBudgetBytes: 2 * half });
    const before = engine.memory().totalBytes;
    const first = await engine.stream(scenes[0]);
    const alone = await drawn(first);
    // The other one waits for a frame to end.
    const { when, give } = signalOf();
    first.stream!.deferUploads(when);
    const ending = new AbortController();
    const coming = engine.stream(scenes[1], { signal: ending.signal });
    const refused = expect(coming).rejects.toThrow('enough');
    await engine.device.queue.onSubmittedWorkDone();
    ending.abort(new Error('enough'));
    give();
    await refused;
    await expect.poll(() => first.bytes).toBeGreaterThan(1.5 * half);
    expect(await drawn(first)).toEqual(alone);

    const next = engine.stream(scenes[1]);
    first.destroy();
    const second = await next;
    expect(second.bytes).toBeGreaterThan(1.5 * half);
    second.destroy();
    expect(engine.memory().totalBytes).toBe(before);
    const lost = [engine.stream(scenes[0]), engine.stream(scenes[1])].map((each) =>
      expect(each).rejects.toThrow(DestroyedError),
    );
    engine.destroy();
    await Promise.all(lost);
    expect(engine.memory().totalBytes).toBe(0);
  });

  gpuTest('are refused where it does not hold their coarsest parts', async () => {
    const { engine } = await start({ streamBudgetBytes: 1000 });
    await expect(engine.stream(scenes[0])).rejects.toThrow(/streamBudgetBytes is 1000; scene 2 needs/);
    expect(engine.memory().scene.totalBytes).toBe(0);
    const cloud = await engine.stream(scenes[0], { budgetBytes: half });
    expect(cloud.bytes).toBeLessThanOrEqual(half);
  });
});
