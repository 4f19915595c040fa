import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterEach, beforeAll, describe, expect, vi } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import type { BrickScene } from '../../data/bricks/brick.ts';
import { brickSceneOf } from '../../data/bricks/make-bricks.ts';
import { perspectiveCamera } from '../../data/camera/camera.ts';
import { SplatFileError, SplatSourceError } from '../../data/errors.ts';
import { SplatEdits } from '../../data/splats/splat-edits.ts';
import { SplatSelection } from '../../data/splats/splat-selection.ts';
import { highlight } from '../../gpu/effects/highlight/highlight.ts';
import { type BrickPort, serveBricks } from '../../io/formats/bricks/serve-bricks.ts';
import { writeSplats } from '../../io/formats/writers.ts';
import { measureAccuracy } from '../../measure/measure-accuracy.ts';
import { drawMeasured } from '../../measure/measured-frames.ts';
import { compareImages } from '../../reference/compare-images.ts';
import { fakeWorker } from '../../testing/fake-worker.ts';
import { FIXED_RASTERIZER } from '../../testing/fixed-rasterizer.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { signalOf } from '../../testing/signal.ts';
import { followEdits } from '../cloud-editor.ts';
import type { StreamReport } from '../cloud-stream.ts';
import { makeRayTree } from '../rays.ts';
import type { SplatCloud } from '../splat-cloud.ts';
import { slotBytes } from './brick-pool.ts';

const SIZE = { widthPx: 96, heightPx: 64 };
const lookFrom = (position: readonly [number, number, number]) =>
  perspectiveCamera({ position, target: [0, 0, 0], up: [0, 1, 0], fovYDegrees: 40, aspect: 1.5 });

describe('a streamed scene', () => {
  const set = randomSplats({ count: 40_000, seed: 2, shDegree: 0, logScales: [-7, -4] });
  let engine: SplatEngine;
  let scene: BrickScene;
  beforeAll(async () => {
    engine = await SplatEngine.create({ device: await shareTestDevice(), accuracy: FIXED_RASTERIZER });
    scene = brickSceneOf(set);
  });

  afterEach(() => vi.unstubAllGlobals());

  async function drawComplete(cloud: SplatCloud, detail = {}, camera = lookFrom([0, 0, 4])) {
    const view = engine.createView();
    view.render({ camera, clouds: [{ cloud }], ...SIZE, ...detail });
    await view.whenComplete();
    const { data } = await view.readPixels();
    const report = view.detail!;
    view.destroy();
    return { data, report };
  }

  gpuTest('shows its coarsest part at once, and in the end what a load shows', async () => {
    const whole = engine.add(set);
    const { when, give } = signalOf();
    const cloud = await engine.stream({
      ...scene,
      read: async (address, signal) => {
        if (address.number > 0) await when;
        return scene.read(address, signal);
      },
    });
    expect(cloud.count).toBe(set.count);
    expect(cloud.stream!.report()).toMatchObject({ residentBricks: 1, missingBricks: 0 });
    const view = engine.createView();
    view.render({ camera: lookFrom([0, 0, 4]), clouds: [{ cloud }], ...SIZE });
    const first = (await view.readPixels()).data;
    expect(first.some((value) => value > 0.1)).toBe(true);
    expect(view.detail).toMatchObject({ isComplete: false, missing: 1 });
    give();
    await view.whenComplete();
    expect(view.detail).toMatchObject({ isComplete: true, missing: 0 });
    const { data } = await view.readPixels();
    const full = (await drawComplete(whole)).data;
    expect(compareImages(data, full, SIZE).psnrDb).toBeGreaterThan(70);
    expect(compareImages(first, full, SIZE).psnrDb).toBeLessThan(40);
    expect(cloud.stream!.report()).toMatchObject({ residentBricks: scene.brickCount, fetching: 0 });
    view.destroy();
    whole.destroy();
    cloud.destroy();
  });

  gpuTest('is loaded from a file in parts; other scenes, and streams, as a whole', async () => {
    const file = await writeSplats(set, 'bricks');
    const cloud = await engine.load(new File([file], 'scene.bricks'));
    expect(cloud.stream!.report()).toMatchObject({ bricks: scene.brickCount, residentBricks: 1 });
    expect(cloud.stream!.report().fetchedBytes).toBeLessThan(0.5 * file.byteLength);
    const { data } = await drawComplete(cloud);
    const streamed = await engine.load(new Blob([file]).stream(), { name: 'scene.bricks' });
    expect(streamed.stream).toBeNull();
    expect(compareImages(data, (await drawComplete(streamed)).data, SIZE).psnrDb).toBeGreaterThan(60);
    await expect(engine.load(new File([file.slice(0, 5000)], 'cut.bricks'))).rejects.toThrow(SplatFileError);
    await expect(engine.load(new File([file], 'a.bricks'), { budgetBytes: 0 })).rejects.toThrow(
      /budgetBytes is 0/,
    );
    streamed.destroy();
    cloud.destroy();
  });

  gpuTest('has a worker of its own as long as its cloud is there', async () => {
    const FakeWorker = fakeWorker((port: BrickPort) => serveBricks(port));
    vi.stubGlobal('Worker', FakeWorker);
    const file = new File([await writeSplats(set, 'bricks')], 'scene.bricks');
    const cloud = await engine.load(file);
    await drawComplete(cloud);
    expect(cloud.stream!.report()).toMatchObject({ residentBricks: scene.brickCount, error: null });
    expect(FakeWorker.requests).toHaveLength(scene.brickCount);
    expect(FakeWorker.started.map(({ isTerminated }) => isTerminated)).toEqual([false]);
    cloud.destroy();
    expect(FakeWorker.started[0].isTerminated).toBe(true);
    await expect(engine.load(file, { budgetBytes: 0 })).rejects.toThrow(/budgetBytes is 0/);
    FakeWorker.behaviour = 'is busy';
    const ending = new AbortController();
    const loading = engine.load(file, { signal: ending.signal });
    await expect.poll(() => FakeWorker.requests.length).toBeGreaterThan(scene.brickCount);
    ending.abort(new Error('enough'));
    await expect(loading).rejects.toThrow('enough');
    expect(FakeWorker.started.every(({ isTerminated }) => isTerminated)).toBe(true);
  });

  gpuTest('fetches only what a view needs', async () => {
    const cloud = await engine.stream(scene);
    await drawComplete(cloud, { detail: { maxErrorPx: 2 } });
    const coarse = cloud.stream!.report();
    expect(coarse.residentBricks).toBeLessThan(scene.brickCount);
    await drawComplete(cloud, {}, lookFrom([0, 0, -100]));
    expect(cloud.stream!.report().residentBricks).toBe(scene.brickCount);
    cloud.destroy();
  });

  gpuTest(
    'stays within its budget, and shows the best that this holds, whatever it showed before',
    async () => {
      const bytes = slotBytes(scene.shDegree);
      const budgetBytes = 4 * bytes.lowest + 4 * bytes.upper;
      const cloud = await engine.stream(scene, { budgetBytes });
      expect(cloud.bytes).toBeLessThan(budgetBytes);
      const detail = { detail: { maxErrorPx: 0.2 } };
      const views = [lookFrom([0, 0, 1.2]), lookFrom([1.2, 0, 0]), lookFrom([0, 0, 1.2])];
      const found = [];
      for (const camera of views) found.push(await drawComplete(cloud, detail, camera));
      const held = cloud.bytes;
      expect(cloud.stream!.report().residentBricks).toBeLessThanOrEqual(8);
      expect(found[2].report).toMatchObject({ isComplete: true });
      expect(found[2].report.missing).toBeGreaterThan(0);
      expect(found[2].data).toEqual(found[0].data);
      expect(found[1].data).not.toEqual(found[0].data);
      expect(cloud.bytes).toBe(held);
      cloud.destroy();
    },
  );

  gpuTest('shows within a budget of splats the same, whatever it showed before', async () => {
    const [fresh, other] = [await engine.stream(scene), await engine.stream(scene)];
    const budget = { detail: { maxSplats: 600 } };
    const found = await drawComplete(fresh, budget);
    expect(found.report).toMatchObject({ isComplete: true, missing: 0 });
    await drawComplete(other, { detail: { maxErrorPx: 0.05 } }, lookFrom([0, 1, 1]));
    expect((await drawComplete(other, budget)).data).toEqual(found.data);
    const view = engine.createView();
    const request = { camera: lookFrom([0, 0, 4]), clouds: [{ cloud: other }], ...SIZE, ...budget };
    const { visibleSplats } = await drawMeasured(engine, view, { ...request, force: true });
    expect(visibleSplats).toBeLessThanOrEqual(600);
    expect(visibleSplats).toBeGreaterThan(500);
    view.destroy();
    fresh.destroy();
    other.destroy();
  });

  gpuTest('tells what it fetches, and when views have all that they need', async () => {
    const { when, give } = signalOf();
    const cloud = await engine.stream({
      ...scene,
      read: async (address, signal) => {
        if (address.number > 0) await when;
        return scene.read(address, signal);
      },
    });
    const { stream } = cloud;
    expect(engine.clouds).toContain(cloud);
    expect(stream!.report()).toMatchObject({ isComplete: false, bytesPerSecond: 0 });
    const seen: StreamReport[] = [];
    const stop = stream!.subscribe(() => seen.push(stream!.report()));
    const view = engine.createView();
    view.render({ camera: lookFrom([0, 0, 4]), clouds: [{ cloud }], ...SIZE });
    expect(seen.at(-1)).toMatchObject({ isComplete: false, missingBricks: 1, fetching: 1 });
    give();
    await view.whenComplete();
    expect(seen.some(({ bytesPerSecond }) => bytesPerSecond > 0)).toBe(true);
    expect(seen.at(-1)).toMatchObject({ isComplete: true, missingBricks: 0, bytesPerSecond: 0 });
    const before = seen.length;
    stop();
    // What a budget needs is known once a frame has been measured.
    const budget = { detail: { maxSplats: 600 } };
    view.render({ camera: lookFrom([0, 0, 4]), clouds: [{ cloud }], ...SIZE, ...budget });
    expect(stream!.report()).toMatchObject({ isComplete: false, missingBricks: 0 });
    await view.whenComplete();
    expect(stream!.report().isComplete).toBe(true);
    expect(seen).toHaveLength(before);
    stream!.subscribe(() => seen.push(stream!.report()));
    cloud.destroy();
    expect(seen.at(-1)).toMatchObject({ isComplete: false });
    expect(engine.clouds).not.toContain(cloud);
    view.destroy();
  });

  gpuTest('tells a part that cannot be read, draws what is there, and goes on when called', async () => {
    let isBroken = true;
    const broken: BrickScene = {
      ...scene,
      read: async (address, signal) => {
        if (isBroken && address.number > 0) throw new SplatSourceError('scene', 'the server is gone.');
        return scene.read(address, signal);
      },
    };
    const cloud = await engine.stream(broken);
    const { data, report } = await drawComplete(cloud);
    expect(data.some((value) => value > 0.1)).toBe(true);
    expect(report.missing).toBeGreaterThan(0);
    expect(cloud.stream!.report()).toMatchObject({
      error: expect.any(SplatSourceError),
      isComplete: false,
    });
    isBroken = false;
    const view = engine.createView();
    view.render({ camera: lookFrom([0, 0, 4]), clouds: [{ cloud }], ...SIZE });
    cloud.stream!.retry();
    await view.whenComplete();
    expect(cloud.stream!.report()).toMatchObject({ error: null, missingBricks: 0 });
    view.destroy();
    cloud.destroy();
  });

  gpuTest('refuses what takes all splats, and keeps what it has', async () => {
    const cloud = await engine.stream(scene);
    const { data } = await drawComplete(cloud);
    await expect(makeRayTree(cloud)).rejects.toThrow(/scene: only parts of it are there/);
    await expect(followEdits(cloud, new SplatEdits())).rejects.toThrow(SplatSourceError);
    const f32 = { geometryPrecision: 'f32', shPrecision: 'f32' } as const;
    await expect(engine.requestPrecision(cloud, f32)).rejects.toThrow(/in the precision of its file/);
    const measured = { clouds: [{ cloud }], cameras: [lookFrom([0, 0, 4])], ...SIZE };
    await expect(measureAccuracy(engine, measured)).rejects.toThrow(/scene: only parts of it are there/);
    await cloud.makeLevels();
    cloud.ownLease.release();
    const view = engine.createView();
    view.render({ camera: lookFrom([0, 0, 4]), clouds: [{ cloud }], ...SIZE });
    expect((await view.readPixels()).data).toEqual(data);
    expect(view.effects().find(({ name }) => name === 'levels')).toMatchObject({
      isOn: true,
      reason: 'blobs stand for what is missing of the scene',
    });
    view.destroy();
    cloud.destroy();
  });

  gpuTest('shows what is selected of the splats that are there, as they come and go', async () => {
    const bytes = slotBytes(scene.shDegree);
    const cloud = await engine.stream(scene, { budgetBytes: 4 * bytes.lowest + 4 * bytes.upper });
    const selection = new SplatSelection();
    selection.add(Array.from({ length: set.count / 2 }, (_, i) => 2 * i));
    const clouds = [{ cloud, effects: [highlight({ selection, color: [0, 1, 0], strength: 0.7 })] }];
    const view = engine.createView();
    const draw = async (position: readonly [number, number, number]) => {
      view.render({ camera: lookFrom(position), clouds, ...SIZE, detail: { maxErrorPx: 0.2 } });
      await view.whenComplete();
      return (await view.readPixels()).data;
    };
    const first = await draw([0, 0, 1.2]);
    await draw([1.2, 0, 0]);
    expect(await draw([0, 0, 1.2])).toEqual(first);
    // Bits of other rows would do for that, if they were the same ones both times.
    const fresh = engine.createView();
    const request = { camera: lookFrom([0, 0, 1.2]), ...SIZE, detail: { maxErrorPx: 0.2 } };
    fresh.render({ ...request, clouds });
    await fresh.whenComplete();
    expect((await fresh.readPixels()).data).toEqual(first);
    fresh.render({ ...request, clouds: [{ cloud }] });
    await fresh.whenComplete();
    expect((await fresh.readPixels()).data).not.toEqual(first);
    view.destroy();
    fresh.destroy();
    cloud.destroy();
  });

  gpuTest('ends fetches with its last view, with its cloud, and while it begins', async () => {
    const signals: AbortSignal[] = [];
    const { when, give } = signalOf();
    const slow: BrickScene = {
      ...scene,
      read: async (address, signal) => {
        if (address.number > 0) {
          signals.push(signal!);
          await when;
        }
        signal?.throwIfAborted();
        return scene.read(address, signal);
      },
    };
    const cloud = await engine.stream(slow);
    const view = engine.createView();
    view.render({ camera: lookFrom([0, 0, 4]), clouds: [{ cloud }], ...SIZE });
    expect(signals.length).toBeGreaterThan(0);
    view.destroy();
    expect(signals.every(({ aborted }) => aborted)).toBe(true);
    const other = engine.createView();
    other.render({ camera: lookFrom([0, 0, 4]), clouds: [{ cloud }], ...SIZE });
    cloud.destroy();
    expect(signals.every(({ aborted }) => aborted)).toBe(true);
    give();
    other.destroy();
    const { totalBytes } = engine.memory();
    await expect(engine.stream(scene, { signal: AbortSignal.abort(new Error('enough')) })).rejects.toThrow(
      'enough',
    );
    await expect(engine.stream(scene, { budgetBytes: 1000 })).rejects.toThrow(
      /budgetBytes is 1000; scene needs/,
    );
    expect(engine.memory().totalBytes).toBe(totalBytes);
  });
});
