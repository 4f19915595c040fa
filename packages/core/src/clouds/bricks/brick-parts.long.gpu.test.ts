import { createServer } from 'node:http';
import type { AddressInfo } from 'node:net';
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterEach, beforeAll, describe, expect, onTestFinished, vi } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import type { BrickScene } from '../../data/bricks/brick.ts';
import { brickSceneOf } from '../../data/bricks/make-bricks.ts';
import { SplatFileError, SplatSourceError } from '../../data/errors.ts';
import { SplatSelection } from '../../data/splats/splat-selection.ts';
import { followEdits } from '../../features/edits/edits.clouds.ts';
import { SplatEdits } from '../../features/edits/splat-edits.data.ts';
import { highlight } from '../../gpu/effects/highlight/highlight.ts';
import { SCENE_TASKS } from '../../io/formats/scene-tasks.ts';
import { writeSplats } from '../../io/formats/writers.ts';
import { measureAccuracy } from '../../measure/measure-accuracy.ts';
import { drawMeasured } from '../../measure/measured-frames.ts';
import { compareImages } from '../../stages/measure/measure.reference.ts';
import { expectEnds, expectReports } from '../../testing/expect-stream.ts';
import { fakeWorker } from '../../testing/fake-worker.ts';
import { FIXED_RASTERIZER } from '../../testing/fixed-rasterizer.ts';
import { drawComplete, lookFrom, SIZE } from '../../testing/look-at-streams.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { signalOf } from '../../testing/signal.ts';
import { makeRayTree } from '../rays/rays.ts';
import { poolBytes } from './brick-pool.ts';

describe('a streamed scene', () => {
  const set = randomSplats({ count: 24_000, seed: 2, shDegree: 0, logScales: [-7, -4] });
  let engine: SplatEngine;
  let scene: BrickScene;
  beforeAll(async () => {
    engine = await SplatEngine.create({ device: await shareTestDevice(), accuracy: FIXED_RASTERIZER });
    scene = brickSceneOf(set);
  });

  afterEach(() => vi.unstubAllGlobals());

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
    const full = (await drawComplete(engine, whole)).data;
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
    const { data } = await drawComplete(engine, cloud);
    const streamed = await engine.load(new Blob([file]).stream(), { name: 'scene.bricks' });
    expect(streamed.stream).toBeNull();
    expect(compareImages(data, (await drawComplete(engine, streamed)).data, SIZE).psnrDb).toBeGreaterThan(60);
    await expect(engine.load(new File([file.slice(0, 5000)], 'cut.bricks'))).rejects.toThrow(SplatFileError);
    await expect(engine.load(new File([file], 'a.bricks'), { budgetBytes: 0 })).rejects.toThrow(
      /budgetBytes is 0/,
    );
    streamed.destroy();
    cloud.destroy();
  });

  gpuTest('asks for less than 2 MB until its first picture is drawn, and for no byte twice', async () => {
    const splats = randomSplats({ count: 80_000, seed: 2, shDegree: 3, logScales: [-7, -4] });
    const file = await writeSplats(splats, 'bricks');
    expect(file.byteLength).toBeGreaterThan(4e6);
    let askedBytes = 0;
    const server = createServer((request, response) => {
      const [, first, last] = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range!)!;
      const part = file.subarray(Number(first), Number(last) + 1);
      askedBytes += part.length;
      const range = `bytes ${first}-${Number(first) + part.length - 1}/${file.length}`;
      response.writeHead(206, { etag: '"1"', 'content-range': range }).end(part);
    });
    onTestFinished(() => void server.close());
    await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
    const { port } = server.address() as AddressInfo;
    const cloud = await engine.load(`http://127.0.0.1:${port}/scene.bricks`);
    const view = engine.createView();
    view.render({ camera: lookFrom([0, 0, 4]), clouds: [{ cloud }], ...SIZE });
    await view.whenDrawn();
    expect(askedBytes).toBeLessThan(2e6);
    await view.whenComplete();
    expect(cloud.stream!.report()).toMatchObject({ isComplete: true, missingBricks: 0 });
    expect(askedBytes).toBe(file.length);
    view.destroy();
    cloud.destroy();
  });

  gpuTest('has a worker of its own as long as its cloud is there', async () => {
    const FakeWorker = fakeWorker(() => SCENE_TASKS);
    vi.stubGlobal('Worker', FakeWorker);
    const file = new File([await writeSplats(set, 'bricks')], 'scene.bricks');
    const cloud = await engine.load(file);
    await drawComplete(engine, cloud);
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
    await drawComplete(engine, cloud, { detail: { maxErrorPx: 4 } });
    const coarse = cloud.stream!.report();
    expect(coarse.residentBricks).toBeLessThan(scene.brickCount);
    await drawComplete(engine, cloud, {}, lookFrom([0, 0, -100]));
    expect(cloud.stream!.report().residentBricks).toBe(scene.brickCount);
    cloud.destroy();
  });

  gpuTest(
    'stays within its budget, and shows the best that this holds, whatever it showed before',
    async () => {
      const budgetBytes = poolBytes(scene.shDegree, { lowest: 4, upper: 1 });
      const cloud = await engine.stream(scene, { budgetBytes });
      expect(cloud.bytes).toBeLessThanOrEqual(budgetBytes);
      const detail = { detail: { maxErrorPx: 0.2 } };
      const views = [lookFrom([0, 0, 1.2]), lookFrom([1.2, 0, 0]), lookFrom([0, 0, 1.2])];
      const found = [];
      for (const camera of views) found.push(await drawComplete(engine, cloud, detail, camera));
      const held = cloud.bytes;
      expect(cloud.stream!.report().residentBricks).toBeLessThanOrEqual(5);
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
    const found = await drawComplete(engine, fresh, budget);
    expect(found.report).toMatchObject({ isComplete: true, missing: 0 });
    await drawComplete(engine, other, { detail: { maxErrorPx: 0.05 } }, lookFrom([0, 1, 1]));
    expect((await drawComplete(engine, other, budget)).data).toEqual(found.data);
    const view = engine.createView();
    const request = { camera: lookFrom([0, 0, 4]), clouds: [{ cloud: other }], ...SIZE, ...budget };
    const { visibleSplats } = await drawMeasured(engine, view, { ...request, force: true });
    expect(visibleSplats).toBeLessThanOrEqual(600);
    expect(visibleSplats).toBeGreaterThan(500);
    view.destroy();
    fresh.destroy();
    other.destroy();
  });

  gpuTest('knows what a budget needs, however many frames come before that is known', async () => {
    const budget = { detail: { maxSplats: 600 } };
    const other = await engine.stream(scene);
    const { data } = await drawComplete(engine, other, budget);
    const cloud = await engine.stream(scene);
    const view = engine.createView();
    const request = { camera: lookFrom([0, 0, 4]), clouds: [{ cloud }], ...SIZE, ...budget };
    for (let frame = 0; frame < 3; frame++) view.render({ ...request, force: true });
    // One that stands takes the place of its equal before.
    view.render(request);
    await view.whenComplete();
    expect(cloud.stream!.report()).toMatchObject({ isComplete: true, missingBricks: 0 });
    expect(cloud.stream!.report().residentBricks).toBe(other.stream!.report().residentBricks);
    expect((await view.readPixels()).data).toEqual(data);
    view.destroy();
    other.destroy();
    cloud.destroy();
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
    expect(engine.clouds).toContain(cloud);
    const fetching = { missingBricks: 1, fetching: 1 };
    await expectReports(
      engine,
      { cloud, camera: lookFrom([0, 0, 4]), ...SIZE },
      { give, fetching, splats: 600 },
    );
    expect(engine.clouds).not.toContain(cloud);
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
    const { data, report } = await drawComplete(engine, cloud);
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

  gpuTest('tells each view what its own picture lacks', async () => {
    const cloud = await engine.stream(scene);
    const { when, give } = signalOf();
    cloud.stream!.deferUploads(when);
    const request = { clouds: [{ cloud }], ...SIZE, detail: { maxErrorPx: 0.5 } };
    const away = lookFrom([0, 0, 4], [0, 0, 8]);
    const cameras = [lookFrom([0, 0, 1.2]), away, lookFrom([0, 0, 90]), lookFrom([0, 0, 1.2])];
    const [view, other] = [engine.createView(), engine.createView()];
    other.render({ ...request, camera: cameras[0] });
    await other.whenDrawn();
    const missing = [];
    for (const camera of cameras) {
      view.render({ ...request, camera });
      await view.whenDrawn();
      missing.push(view.detail!.missing);
      await engine.device.queue.onSubmittedWorkDone();
      expect(view.detail!.missing).toBe(missing.at(-1));
    }
    expect(missing).toEqual([1, 0, 0, 1]);
    expect(other.detail!.missing).toBe(1);
    give();
    await view.whenComplete();
    expect(view.detail).toMatchObject({ missing: 0, isComplete: true });
    for (const each of [view, other, cloud]) each.destroy();
  });

  gpuTest('refuses what takes all splats, and keeps what it has', async () => {
    const cloud = await engine.stream(scene);
    const { data } = await drawComplete(engine, cloud);
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
      reason: 'merged splats stand for missing parts of the scene',
    });
    view.destroy();
    cloud.destroy();
  });

  gpuTest('shows what is selected of the splats that are there, as they come and go', async () => {
    const budgetBytes = poolBytes(scene.shDegree, { lowest: 4, upper: 1 });
    const cloud = await engine.stream(scene, { budgetBytes });
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
    await expectEnds(engine, { cloud, camera: lookFrom([0, 0, 4]), ...SIZE }, signals);
    give();
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
