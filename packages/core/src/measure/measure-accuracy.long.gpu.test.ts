// Proves: measured errors are those of images read back, of details too.
import { gpuTest, sharedTestGpu, watchDevice } from '@websplatter/node/gpu-test';
import { stillLifeCameras } from '@websplatter/scenes';
import { afterAll, beforeAll, describe, expect, vi } from 'vitest';
import { SplatEngine } from '../create-engine.ts';
import type { AccuracySettings, FrameRasterizer } from '../data/accuracy/accuracy.ts';
import { perspectiveCamera } from '../data/camera/camera.ts';
import type { SortBy } from '../data/splats/sort-by.ts';
import type { CloudInstance } from '../frame/plan/frame-request.ts';
import { averageSamples, compareImages } from '../stages/measure/measure.reference.ts';
import { everyOf, stillLife } from '../testing/still-life.ts';
import { cameraAtDistance } from './camera-pivot.ts';
import { chooseAccuracy } from './choose-accuracy.ts';
import { compareViews } from './compare-views.ts';
import {
  type AccuracyPoint,
  type AccuracyTable,
  countMeasureSteps,
  type MeasureProgress,
  measureAccuracy,
} from './measure-accuracy.ts';
import { measureTarget } from './measure-target.ts';
import type { MeasuredEngine } from './measured-engine.ts';
import { drawMeasured } from './measured-frames.ts';
import { sampleCameras } from './sample-cameras.ts';
import { CROPS } from './supersampled-picture.ts';

// Small: SwiftShader takes a second for frames of the whole scene, and hundreds are measured.
const SIZE = { widthPx: 24, heightPx: 24 };
const SPLATS = 1000;

/** Times are compared in the full run only: it takes many frames to tell them apart. */
const isFull = process.env.WEBSPLATTER_FULL === '1';

let engine: SplatEngine;
let clouds: CloudInstance[];
let common: { clouds: CloudInstance[]; cameras: ReturnType<typeof perspectiveCamera>[] } & typeof SIZE;

beforeAll(async () => {
  const adapter = await sharedTestGpu.requestAdapter();
  engine = await SplatEngine.create({ adapter, accuracy: 'reference' });
  watchDevice(engine.device);
  clouds = [{ cloud: engine.add(everyOf(await stillLife(), 10), { name: 'still life' }) }];
  const camera = perspectiveCamera({ ...stillLifeCameras[0], aspect: 1 });
  common = { clouds, cameras: [camera], ...SIZE };
});
afterAll(() => engine?.destroy());

/** Makes the cloud hold the precisions of `settings`: measuring frees those that it made. */
function hold({ geometryPrecision, shPrecision }: AccuracySettings): Promise<void> {
  const [{ cloud }] = clouds;
  return cloud.hold({ geometryPrecision, shPrecision }).met;
}

describe('measureAccuracy', () => {
  gpuTest('errors equal those of the CPU for images read back, to 0.1 dB', async () => {
    const table = await measureAccuracy(engine, {
      ...common,
      frames: 1,
      combinations: false,
      settings: ['alphaCutoff'],
    });
    const views = [engine.createView(), engine.createView()] as const;
    const draw = async (view: (typeof views)[number], accuracy: AccuracySettings) => {
      view.render({ ...common, camera: common.cameras[0], accuracy });
      return (await view.readPixels()).data;
    };
    const reference = await draw(views[0], table.reference.settings);
    expect(table.points.length).toBeGreaterThanOrEqual(6);
    for (const { name, settings, error } of table.points) {
      await hold(settings);
      const expected = compareImages(await draw(views[1], settings), reference, SIZE);
      if (expected.psnrDb === Number.POSITIVE_INFINITY) expect(error.psnrDb, name).toBe(expected.psnrDb);
      else expect(Math.abs(error.psnrDb - expected.psnrDb), name).toBeLessThan(0.1);
      expect(Math.abs(error.maxError - expected.maxError), name).toBeLessThan(1e-6);
      expect(Math.abs(error.ssim - expected.ssim), name).toBeLessThan(1e-4);
      expect(await compareViews(views[1], views[0]), name).toEqual(error);
    }
    for (const view of views) view.destroy();
  });

  gpuTest('every frame is sorted as those are that it is measured for', async ({ skip }) => {
    if (process.env.WEBSPLATTER_FULL !== '1') skip('set WEBSPLATTER_FULL=1');
    const orders = new Set<string>();
    const options = { ...common, frames: 1, settings: [], ablations: false, combinations: false };
    const watched: MeasuredEngine = {
      ...{ device: engine.device, adapterLabel: engine.adapterLabel, lost: engine.lost },
      accuracy: engine.accuracy,
      resolveAccuracy: (accuracy) => engine.resolveAccuracy(accuracy),
      memory: () => engine.memory(),
      createView: () => {
        const view = engine.createView();
        const whenDrawn = view.whenDrawn.bind(view);
        view.whenDrawn = async () => {
          await whenDrawn();
          const order = view.effects().find(({ name }) => name === 'distance-order');
          orders.add(`${order?.isOn}: ${order?.reason}`);
        };
        return view;
      },
    };
    const ordersBy = async (sortBy?: SortBy) => {
      orders.clear();
      await measureAccuracy(watched, { ...options, sortBy });
      return [...orders];
    };
    expect(await ordersBy('distance')).toEqual(['true: the request asks for it']);
    expect(await ordersBy('depth')).toEqual(['false: the request asks for depths']);
    expect(await ordersBy()).toEqual(['false: no file asks for it']);

    orders.clear();
    const request = { ...common, camera: common.cameras[0], sortBy: 'distance' } as const;
    const target = { minPsnrDb: 20 };
    await measureTarget(watched, target, request, { previous: null, signal: new AbortController().signal });
    expect([...orders]).toEqual(['true: the request asks for it']);
  });

  gpuTest('two measurements rank points alike if their intervals do not overlap', async ({ skip }) => {
    if (!isFull) skip('set WEBSPLATTER_FULL=1');
    // A hundred of the splats are in sight, so that drawing all that are near takes three times as
    // long: there is a difference to find, and a frame takes milliseconds.
    const camera = perspectiveCamera({ ...stillLifeCameras[0], fovYDegrees: 4, aspect: 1 });
    const options = {
      ...common,
      cameras: [camera],
      settings: ['culling'],
      combinations: false,
      // Six visits. Other work of this machine slows the frames of a visit together, so with few
      // visits it could set points apart that take equally long. With six it has to slow five of
      // one point and spare five of the other, and then, in the second measurement, the other way
      // round.
      frames: 18,
    };
    const [first, second] = [await measureAccuracy(engine, options), await measureAccuracy(engine, options)];
    expect(second.points.map(({ name, error }) => [name, error])).toEqual(
      first.points.map(({ name, error }) => [name, error]),
    );
    const isFaster = (a: AccuracyPoint, b: AccuracyPoint) => a.timeMs.total.high < b.timeMs.total.low;
    const contradictions = first.points.flatMap((a, i) =>
      first.points
        .filter((b, j) => isFaster(a, b) && isFaster(second.points[j], second.points[i]))
        .map((b) => `${a.name} before ${b.name}, then after it`),
    );
    expect(contradictions).toEqual([]);
    // They find differences too: slower points take longer. Load moves the lower ends least.
    const leastMs = (name: string) =>
      Math.min(
        ...[first, second].map(({ points }) => points.find((each) => each.name === name)!.timeMs.total.low),
      );
    expect(leastMs('paper')).toBeLessThan(leastMs('paper −CULL'));
  });

  gpuTest('reads finer planes again if they are needed, and frees them afterwards', async () => {
    const cloud = engine.add(everyOf(await stillLife(), 10));
    await engine.requestPrecision(cloud, { geometryPrecision: 'packed', shPrecision: 'u8' });
    const before = engine.memory().totalBytes;
    const options = { ...common, clouds: [{ cloud }], frames: 1, settings: [], combinations: false };
    const table = await measureAccuracy(engine, options);
    const { points, reference } = table;
    expect(reference.notes.join()).not.toContain('nearest');
    const [balanced, ofReference] = points;
    expect(ofReference.error.psnrDb).toBe(Number.POSITIVE_INFINITY);
    expect(balanced.error.psnrDb).toBeLessThan(80);
    expect(cloud.precisions).toEqual({ geometry: ['packed'], sh: ['u8'] });
    expect(engine.memory().totalBytes).toBe(before);
    cloud.destroy();
  });

  gpuTest('reports progress, tries combinations, and leaves nothing behind', async () => {
    const before = engine.memory().totalBytes;
    const progress: MeasureProgress[] = [];
    const { accuracy } = engine;
    const options = { ...common, frames: 2, settings: ['sortKeyBits', 'alphaCutoff'] };
    const table = await measureAccuracy(engine, { ...options, onProgress: (each) => progress.push(each) });
    expect(progress[0].total).toBe(countMeasureSteps(options));
    expect(engine.memory().totalBytes).toBe(before);
    expect(engine.accuracy).toBe(accuracy);
    expect(progress.map(({ done }) => done)).toEqual(progress.map((_, i) => i));
    const steps = progress.length - 1;
    expect(progress.at(-1)).toMatchObject({ done: steps, total: steps });
    for (const { done, total } of progress.slice(0, -1)) expect(done).toBeLessThan(total);
    expect(table).toMatchObject({
      ...SIZE,
      views: 1,
      frames: 2,
      splats: SPLATS,
      adapter: engine.adapterLabel,
    });
    expect(table.points[0]).toMatchObject({ name: 'balanced', changed: [] });
    expect(new Set(table.points.map(({ settings }) => settings)).size).toBe(table.points.length);
    for (const { name, timeMs, bytes, changed, settings } of table.points) {
      expect(timeMs.total.median, name).toBeGreaterThan(0);
      expect(timeMs.total.low, name).toBeLessThanOrEqual(timeMs.total.high);
      expect(bytes, name).toBeGreaterThan(SPLATS * 32);
      for (const setting of changed) expect(settings[setting]).not.toBe(table.base[setting]);
    }
    expect(table.points.filter(({ isOnFront }) => isOnFront).length).toBeGreaterThan(0);
  });

  gpuTest('tells what has been timed each time that there is more, the whole table at last', async () => {
    const told: AccuracyTable[] = [];
    const steps: MeasureProgress[] = [];
    const stepsBefore: number[] = [];
    const options = { ...common, frames: 4, settings: [], ablations: false, combinations: false };
    const table = await measureAccuracy(engine, {
      ...options,
      onProgress: (each) => steps.push(each),
      onTable: (each) => {
        told.push(each);
        stepsBefore.push(steps.length);
      },
    });
    const names = table.points.map(({ name }) => name);
    // Each is timed right after it has been compared.
    expect(stepsBefore.slice(0, names.length)).toEqual(names.map((_, i) => 2 * (i + 1)));
    expect(steps[2]).toMatchObject({
      label: `2 of ${names.length}: ${names[1]}`,
      point: { name: names[1], settings: table.points[1].settings },
    });
    // Two rounds, of which the second runs backwards.
    const counts = told.map(({ points }) => points.length);
    expect(counts).toEqual([...names.map((_, i) => i + 1), ...names.map(() => names.length)]);
    for (const { points, base } of told) {
      expect(points.map(({ name }) => name)).toEqual(names.slice(0, points.length));
      expect(points.some(({ isOnFront }) => isOnFront)).toBe(true);
      expect(base).toBe(table.base);
    }
    expect({ ...told.at(-1), elapsedMs: 0 }).toEqual({ ...table, elapsedMs: 0 });
  });

  gpuTest(
    'details are measured against the full scene, and all against what the eye should see',
    async () => {
      const cloud = engine.add(everyOf(await stillLife(), 4), { name: 'a quarter' });
      const progress: MeasureProgress[] = [];
      const camera = cameraAtDistance(common.cameras[0], [{ cloud }], 2);
      const options = {
        ...common,
        ...{ clouds: [{ cloud }], cameras: [...common.cameras, camera] },
        ...({ base: 'reference', frames: 1, settings: ['alphaCutoff'], ablations: false } as const),
        details: [{ maxShare: 0.5 }, { maxErrorPx: 4 }],
      };
      const table = await measureAccuracy(engine, { ...options, onProgress: (each) => progress.push(each) });
      expect(progress[0].total).toBe(countMeasureSteps(options));
      const steps = progress.length - 1;
      expect(progress.at(-1)).toMatchObject({ done: steps, total: steps });
      for (const { done, total } of progress.slice(0, -1)) expect(done).toBeLessThan(total);
      const [base] = table.points;
      const [half, coarse] = table.points.slice(-2);
      expect(
        [half, coarse].map(({ name, detail, changed, settings }) => [name, detail, changed, settings]),
      ).toEqual([
        ['50 % of splats', options.details[0], [], table.base],
        ['4 px of error', options.details[1], [], table.base],
      ]);
      expect(table.detail).toBe('full');
      expect(base.error.psnrDb).toBe(Number.POSITIVE_INFINITY);
      // Its view has room for fewer splats.
      expect(half.bytes - base.bytes).toBeGreaterThan(0.5 * cloud.levels!.bytes);

      const [tested, full] = [engine.createView(), engine.createView()];
      for (const point of table.points) {
        const { name, settings, detail, error, filteredPsnrDb, splats, notes, rasterizers } = point;
        await cloud.hold(settings).met;
        /** As drawn by one rasteriser: which one is chosen follows from times. */
        const findBy = async (rasterizer: FrameRasterizer) => {
          const found = { psnrDb: Infinity, filteredPsnrDb: Infinity, splats: 0 };
          for (const each of options.cameras) {
            const frame = { ...common, clouds: [{ cloud }], camera: each };
            const accuracy = { ...settings, rasterizer };
            const { visibleSplats } = await drawMeasured(engine, tested, { ...frame, accuracy, detail });
            const exact = { preset: 'reference', rasterizer } as const;
            await drawMeasured(engine, full, { ...frame, accuracy: exact, force: true });
            const fine = { widthPx: 4 * SIZE.widthPx, heightPx: 4 * SIZE.heightPx };
            const atOnce = engine.createView();
            atOnce.render({ ...frame, ...fine, accuracy: 'reference' });
            const filtered = averageSamples((await atOnce.readPixels()).data, SIZE, 4);
            atOnce.destroy();
            const { data } = await tested.readPixels();
            found.psnrDb = Math.min(found.psnrDb, (await compareViews(tested, full)).psnrDb);
            const { psnrDb } = compareImages(data, filtered, SIZE);
            found.filteredPsnrDb = Math.min(found.filteredPsnrDb, psnrDb);
            found.splats = Math.max(found.splats, visibleSplats);
          }
          return found;
        };
        const found: Awaited<ReturnType<typeof findBy>>[] = [];
        for (const each of rasterizers) found.push(await findBy(each));
        const leastOff = (measured: number, by: (each: (typeof found)[number]) => number) =>
          Math.min(...found.map((each) => (measured === by(each) ? 0 : Math.abs(measured - by(each)))));
        expect(splats, name).toBe(found[0].splats);
        expect(
          leastOff(error.psnrDb, (each) => each.psnrDb),
          name,
        ).toBeLessThan(0.1);
        expect(
          leastOff(filteredPsnrDb!, (each) => each.filteredPsnrDb),
          name,
        ).toBeLessThan(0.1);
        expect(notes.join(), name).not.toContain('All splats');
      }
      for (const view of [tested, full]) view.destroy();
      expect(half.splats).toBeLessThanOrEqual(1250);
      expect(coarse.splats).toBeLessThan(base.splats);
      expect(half.error.psnrDb).toBeLessThan(60);
      cloud.destroy();
    },
  );

  gpuTest('clouds without levels have a note instead of details, and no steps for them', async () => {
    const cloud = engine.add(everyOf(await stillLife(), 10));
    vi.spyOn(cloud, 'makeLevels').mockRejectedValue(new Error('There is no memory for levels.'));
    const options = { ...common, clouds: [{ cloud }], frames: 1, settings: [], combinations: false };
    const totals: number[] = [];
    const table = await measureAccuracy(engine, {
      ...options,
      details: [{ maxSplats: 5 }],
      onProgress: ({ total }) => totals.push(total),
    });
    expect(table.notes).toContainEqual(
      expect.stringMatching(/^Less than full detail is left out: .*no memory/),
    );
    expect(totals[0]).toBe(countMeasureSteps(options));
    for (const { detail, filteredPsnrDb } of table.points)
      expect([detail, filteredPsnrDb]).toEqual(['full', null]);
    cloud.destroy();
  });

  gpuTest('settings that draw all splats whatever the detail say so', async () => {
    const options = { ...common, frames: 1, settings: [], combinations: false, ablations: false };
    const { points } = await measureAccuracy(engine, {
      ...options,
      base: 'paper',
      details: [{ maxSplats: 5 }],
    });
    expect(points.at(-1)!.splats).toBe(points[0].splats);
    expect(points.at(-1)!.notes).toContain(
      'All splats are drawn: records of 24 bytes hold no opacity above 1.',
    );
  });

  gpuTest('ends when its signal is aborted, and frees its views', async () => {
    await clouds[0].cloud.makeLevels();
    const before = engine.memory().totalBytes;
    // While a picture is drawn, and after that.
    for (const last of [8, CROPS + 8]) {
      const ending = new AbortController();
      const measuring = measureAccuracy(engine, {
        ...common,
        details: [{ maxSplats: 500 }],
        signal: ending.signal,
        onProgress: ({ done }) => {
          if (done === last) ending.abort(new Error('enough'));
        },
      });
      await expect(measuring).rejects.toThrow('enough');
      expect(engine.memory().totalBytes).toBe(before);
    }
  });

  gpuTest('rejects invalid options', async () => {
    await expect(measureAccuracy(engine, { ...common, cameras: [] })).rejects.toThrow('no cameras');
    await expect(measureAccuracy(engine, { ...common, frames: 0 })).rejects.toThrow('frames is 0');
    await expect(measureAccuracy(engine, { ...common, settings: ['sharpness'] })).rejects.toThrow(
      '"sharpness"',
    );
    for (const wrong of ['auto', { minPsnrDb: 40 }])
      await expect(measureAccuracy(engine, { ...common, details: [wrong as never] })).rejects.toThrow(
        /^details is .* 'full' or limits/,
      );
    await expect(measureAccuracy(engine, { ...common, details: [{ maxSplats: 0 }] })).rejects.toThrow(
      'detail is',
    );
    const both = { ...common, detail: { maxErrorPx: 1 }, details: [{ maxSplats: 5 }] };
    await expect(measureAccuracy(engine, both)).rejects.toThrow('details are compared with the full scene');
  });
});

describe('chooseAccuracy', () => {
  gpuTest('chooses settings whose measured error meets the target, from every side', async () => {
    const cameras = sampleCameras(common.cameras[0], clouds[0].cloud.robustBounds, 2);
    const options = { ...common, cameras, frames: 1, settings: ['alphaCutoff'], combinations: false };
    const choice = await chooseAccuracy(engine, { minPsnrDb: 40 }, options);
    expect(choice.isMet).toBe(true);
    expect(choice.why).toContain('reach 40 dB');
    const [tested, reference] = [engine.createView(), engine.createView()];
    await hold(choice.settings);
    for (const camera of cameras) {
      tested.render({ ...common, camera, accuracy: choice.settings });
      reference.render({ ...common, camera, accuracy: choice.table.reference.settings });
      expect((await compareViews(tested, reference)).psnrDb).toBeGreaterThanOrEqual(40);
    }
    for (const view of [tested, reference]) view.destroy();
    const few = { ...options, cameras: cameras.slice(0, 1), settings: [] };
    const impossible = await chooseAccuracy(engine, { maxFrameMs: 1e-6 }, few);
    expect(impossible).toMatchObject({ isMet: false, why: expect.stringContaining('None of the') });
  });
});
