import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect, onTestFinished, vi } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import type { LeafScene } from '../../data/bricks/leaf-scene.ts';
import { SplatFileError, SplatSourceError } from '../../data/errors.ts';
import { openLeaves } from '../../io/formats/sog/open-leaves.ts';
import { readSplats } from '../../io/loading/read-splats.ts';
import { knownSource } from '../../io/sources/known-source.ts';
import { compareImages } from '../../stages/measure/measure.reference.ts';
import { expectEnds, expectReports } from '../../testing/expect-stream.ts';
import { FIXED_RASTERIZER } from '../../testing/fixed-rasterizer.ts';
import {
  byLevel,
  drawComplete,
  expectCuts,
  expectOneLevel,
  lookFrom,
  SIZE,
  streamContext,
} from '../../testing/look-at-streams.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { signalOf } from '../../testing/signal.ts';
import { droppedFiles } from '../../testing/sog-fixture.ts';
import { type StreamedSog, streamedSog, streamedSogFiles } from '../../testing/streamed-sog-fixture.ts';
import { zipBytes } from '../../testing/zip-fixture.ts';
import type { SplatCloud } from '../splat-cloud.ts';
import { chunkBytes } from '../stream/chunk-pages.ts';
import { streamLeaves } from './stream-leaves.ts';

describe('a streamed SOG', () => {
  const set = randomSplats({ count: 12_000, seed: 2, shDegree: 1, logScales: [-6, -4] });
  const environment = randomSplats({ count: 300, seed: 3, shDegree: 0, halfExtent: 4, logScales: [-3, -2] });
  let engine: SplatEngine;
  let sog: StreamedSog;
  beforeAll(async () => {
    engine = await SplatEngine.create({ device: await shareTestDevice(), accuracy: FIXED_RASTERIZER });
    sog = await streamedSog({ set, filesOfLevel: [4, 2, 1], leafCount: 12, environment });
  });

  const dropped = (from = sog) => droppedFiles(streamedSogFiles(from, 'scene/'));
  const opened = async () => (await openLeaves(knownSource(dropped())))!;
  /** One that several clouds show. */
  const lasting = async () => ({ ...(await opened()), end: () => {} });
  const stream = (scene: LeafScene, budgetBytes?: number) =>
    streamLeaves(streamContext(engine.device), scene, { budgetBytes }, {});

  gpuTest('shows a coarse picture at once, and in the end its finest level', async () => {
    const whole = engine.add(await readSplats(dropped()));
    const { data: full } = await drawComplete(engine, whole);
    const loaded = await engine.load(dropped());
    expect(loaded.count).toBe(set.count + environment.count);
    const { residentBricks, bricks, fetchedBytes } = loaded.stream!.report();
    expect(residentBricks).toBeLessThan(0.3 * bricks);
    expect((await drawComplete(engine, loaded)).report).toMatchObject({ isComplete: true, missing: 0 });
    expect(loaded.stream!.report().fetchedBytes).toBeGreaterThan(2 * fetchedBytes);
    loaded.destroy();
    const scene = await opened();
    const { when, give } = signalOf();
    const firstFiles = new Set(scene.leaves.map(({ levels }) => levels.at(-1)!.file));
    const cloud = await stream({
      ...scene,
      read: async (file, signal) => {
        if (!firstFiles.has(file)) await when;
        return scene.read(file, signal);
      },
    });
    const view = engine.createView();
    view.render({ camera: lookFrom([0, 0, 4]), clouds: [{ cloud }], ...SIZE });
    const first = (await view.readPixels()).data;
    expect(view.detail).toMatchObject({ isComplete: false });
    expect(first.some((value) => value > 0.1)).toBe(true);
    give();
    await view.whenComplete();
    expect(view.detail).toMatchObject({ isComplete: true, missing: 0 });
    const { data } = await view.readPixels();
    expect(compareImages(first, full, SIZE).psnrDb).toBeLessThan(40);
    expect(compareImages(data, full, SIZE).psnrDb).toBeGreaterThan(60);
    view.destroy();
    whole.destroy();
    cloud.destroy();
  });

  gpuTest('is loaded from an archive, too, and other archives as they were', async () => {
    const { data } = await drawComplete(engine, await engine.load(dropped()));
    const files = streamedSogFiles(sog, 'a/');
    for (const isDeflated of [false, true]) {
      const cloud = await engine.load(new File([zipBytes(files, { isDeflated })], 'scene.zip'));
      expect(cloud.stream).not.toBeNull();
      expect((await drawComplete(engine, cloud)).data).toEqual(data);
      cloud.destroy();
    }
    const inside = Object.entries(sog.files).filter(([path]) => path.startsWith('0_0/'));
    const other = await engine.load(new File([zipBytes(Object.fromEntries(inside))], 'scene.sog'));
    expect(other.stream).toBeNull();
    other.destroy();
  });

  gpuTest('draws one level of each leaf at each moment, while they come and go', async () => {
    const scene = await opened();
    const chunks = scene.leaves.flatMap(({ levels }) => levels.map(({ count }) => Math.ceil(count / 256)));
    const all = chunks.reduce((sum, count) => sum + count, 0);
    const cloud = await stream(byLevel(scene), 0.5 * all * chunkBytes(scene.shDegree));
    const expectCut = (numbers: readonly number[], when: string) => expectOneLevel(scene, numbers, when);
    await expectCuts(engine, cloud, { steps: 25, reach: 2.5 }, expectCut);
  });

  gpuTest('shows the same bit for bit, whatever it showed before, within its budget', async () => {
    const scene = await lasting();
    const budgetBytes = 44 * chunkBytes(scene.shDegree);
    const views = [
      { camera: lookFrom([0.1, 0.3, 1.2]), detail: { maxErrorPx: 2 } },
      { camera: lookFrom([1.2, 0.4, 0.2]), detail: 'full' },
      { camera: lookFrom([9, 14, 21]), detail: { maxErrorPx: 1 } },
      { camera: lookFrom([0.3, -2, 2]), detail: { maxSplats: 2500 } },
    ] as const;
    const found = [];
    for (const { camera, detail } of views) {
      const fresh = await stream(scene, budgetBytes);
      expect(fresh.bytes).toBeLessThanOrEqual(budgetBytes);
      found.push(await drawComplete(engine, fresh, { detail }, camera));
      expect(found.at(-1)!.report).toMatchObject({ isComplete: true });
      fresh.destroy();
    }
    expect(found[1].report.missing).toBeGreaterThan(0);
    expect(found[2].report.missing).toBe(0);
    const cloud = await stream(scene, budgetBytes);
    for (const i of [2, 0, 3, 1, 0, 2, 1, 3]) {
      const { camera, detail } = views[i];
      expect((await drawComplete(engine, cloud, { detail }, camera)).data, `view ${i}`).toEqual(
        found[i].data,
      );
      expect(cloud.bytes).toBeLessThanOrEqual(budgetBytes);
    }
    cloud.destroy();
  });

  gpuTest('takes as much memory as what it has needs, and little more', async () => {
    const cloud = await stream(await lasting(), Number.POSITIVE_INFINITY);
    const takes = async (camera: ReturnType<typeof lookFrom>, detail: 'full' | { maxErrorPx: number }) => {
      await drawComplete(engine, cloud, { detail }, camera);
      const { residentBricks } = cloud.stream!.report();
      return { bytes: cloud.bytes, residentBytes: residentBricks * chunkBytes(1) };
    };
    const far = await takes(lookFrom([0, 0, 60]), { maxErrorPx: 1 });
    const near = await takes(lookFrom([0, 0, 4]), 'full');
    expect(near.bytes).toBeGreaterThan(2 * far.bytes);
    for (const { bytes, residentBytes } of [far, near]) expect(bytes).toBeLessThan(1.3 * residentBytes);
    cloud.destroy();
  });

  gpuTest('fetches only what a view needs, and within a budget of splats less', async () => {
    const residentAfter = async (detail: object, camera = lookFrom([0, 0, 4])) => {
      const cloud = await stream(await opened());
      await drawComplete(engine, cloud, detail, camera);
      const { residentBricks } = cloud.stream!.report();
      cloud.destroy();
      return residentBricks;
    };
    const full = await residentAfter({});
    const far = await residentAfter({ detail: { maxErrorPx: 1 } }, lookFrom([0, 0, 60]));
    const budgeted = await residentAfter({ detail: { maxSplats: 2000 } });
    const away = { ...lookFrom([0, 0, 4]), viewMatrix: lookFrom([0, 0, -4]).viewMatrix };
    expect(far).toBeLessThan(0.3 * full);
    expect(budgeted).toBeLessThan(0.7 * full);
    expect(budgeted).toBeGreaterThan(far);
    expect(await residentAfter({ detail: { maxErrorPx: 1 } }, away)).toBeGreaterThan(far);
  });

  gpuTest('tells what it fetches, and when views have all that they need', async () => {
    const scene = await opened();
    const { when, give } = signalOf();
    const packing = signalOf();
    let isFirst = true;
    const cloud = await stream({
      ...scene,
      read: async (file, signal, onBytes) => {
        const isHeld = !isFirst;
        if (isHeld) await when;
        const fetched = await scene.read(file, signal, onBytes);
        const pack: typeof fetched.pack = async (...args) => {
          if (isHeld) await packing.when;
          return fetched.pack(...args);
        };
        return { pack };
      },
    });
    isFirst = false;
    const fetching = { fetching: 4, bytesPerSecond: 0 };
    await expectReports(
      engine,
      { cloud, camera: lookFrom([0, 0, 4]), ...SIZE },
      { give, release: packing.give, fetching, splats: 2000 },
    );
  });

  /**
   * @fault Files: a file of a streamed SOG is missing, damaged, or contradicts the tree (number of splats,
   *   harmonics, bounds)
   */
  gpuTest('tells what cannot be read, draws what is there, and goes on when online or called', async () => {
    const page = new EventTarget();
    vi.stubGlobal('addEventListener', page.addEventListener.bind(page));
    onTestFinished(() => void vi.unstubAllGlobals());
    const scene = await lasting();
    const coarse = scene.leaves[0].levels.at(-1)!.file;
    for (const [error, from] of [
      [new SplatSourceError('0_0/meta.json', 'it is gone.'), SplatSourceError],
      [new SplatFileError('damaged', '0_0/meta.json', 'it is damaged.'), SplatFileError],
    ] as const) {
      let isBroken = true;
      const isCoarse = (file: number) => file === coarse || file === scene.leaves.at(-1)!.levels[0].file;
      const broken: LeafScene = {
        ...scene,
        read: async (file, signal) => {
          if (isBroken && !isCoarse(file)) throw error;
          return scene.read(file, signal);
        },
      };
      const cloud = await stream(broken);
      const { data, report } = await drawComplete(engine, cloud);
      expect(data.some((value) => value > 0.1)).toBe(true);
      expect(report.missing).toBeGreaterThan(0);
      expect(cloud.stream!.report()).toMatchObject({ error: expect.any(from), isComplete: false });
      isBroken = false;
      const view = engine.createView();
      view.render({ camera: lookFrom([0, 0, 4]), clouds: [{ cloud }], ...SIZE });
      page.dispatchEvent(new Event('online'));
      if (from === SplatFileError) {
        expect(cloud.stream!.report().error).toBeInstanceOf(from);
        cloud.stream!.retry();
      }
      await view.whenComplete();
      expect(cloud.stream!.report()).toMatchObject({ error: null, missingBricks: 0 });
      view.destroy();
      cloud.destroy();
    }
  });

  gpuTest('finds the row of a splat where its finest level is there, and none where not', async () => {
    const { meta, files } = sog;
    const scene = { meta: { ...meta, environment: undefined }, files };
    const whole = engine.add(await readSplats(dropped(scene)));
    const cloud = await engine.load(dropped(scene));
    const picks = async (shown: SplatCloud) => {
      const view = engine.createView();
      view.render({ camera: lookFrom([0, 0, 4]), clouds: [{ cloud: shown }], ...SIZE });
      const found = [];
      for (const xPx of [30, 40, 48, 55, 60]) found.push((await view.pick(xPx, 32))?.row);
      const done = view.whenComplete();
      await done;
      const later = [];
      for (const xPx of [30, 40, 48, 55, 60]) later.push((await view.pick(xPx, 32))?.row);
      view.destroy();
      return { found, later };
    };
    const { later: expected } = await picks(whole);
    const { later } = await picks(cloud);
    expect(expected.filter((row) => row !== undefined).length).toBeGreaterThan(3);
    expect(later).toEqual(expected);
    whole.destroy();
    cloud.destroy();
  });

  gpuTest(
    'ends fetches with its last view and with its cloud, and leaves nothing of a failed load',
    async () => {
      const scene = await opened();
      const signals: AbortSignal[] = [];
      const { when, give } = signalOf();
      let isFirst = true;
      const slow: LeafScene = {
        ...scene,
        read: async (file, signal) => {
          if (!isFirst) {
            signals.push(signal!);
            await when;
          }
          signal?.throwIfAborted();
          return scene.read(file, signal);
        },
      };
      const cloud = await stream(slow);
      isFirst = false;
      await expectEnds(engine, { cloud, camera: lookFrom([0, 0, 4]), ...SIZE }, signals);
      give();
      const { totalBytes } = engine.memory();
      const aborted = { signal: AbortSignal.abort(new Error('enough')) };
      await expect(engine.load(dropped(), aborted)).rejects.toThrow('enough');
      await expect(engine.load(dropped(), { budgetBytes: 1000 })).rejects.toThrow(
        /budgetBytes is 1000; .* needs/,
      );
      const { '2_0/quats.webp': _, ...others } = sog.files;
      await expect(engine.load(dropped({ ...sog, files: others }))).rejects.toMatchObject({
        code: 'missing-part',
      });
      expect(engine.memory().totalBytes).toBe(totalBytes);
    },
  );
});
