// Proves: pictures at rest keep decibels, moving ones milliseconds, and views report both.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, beforeEach, describe, expect, vi } from 'vitest';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { SplatEngine } from '../create-engine.ts';
import { type Camera, perspectiveCamera } from '../data/camera/camera.ts';
import type { Detail } from '../frame/plan/detail.ts';
import { antialias } from '../gpu/effects/antialias/antialias.ts';
import { wallClockTimings } from '../gpu/timing/frame-statistics.ts';
import { GpuTimer } from '../gpu/timing/gpu-timer.ts';
import { compareImages } from '../reference/index.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { FramePace } from './frame-pace.ts';
import type { SplatView } from './splat-view.ts';
import { RESTS_AFTER_MS } from './view-detail.ts';

const SIZE = { widthPx: 96, heightPx: 64 };
const SET = randomSplats({ count: 9000, seed: 3, shDegree: 0, logScales: [-6, -4] });
/** No frame is drawn in that time. */
const NEVER_MS = 1e-6;

const camera = (distance: number): Camera =>
  perspectiveCamera({
    position: [0.4 * distance, 0.3 * distance, distance],
    target: [0, 0, 0],
    fovYDegrees: 40,
    aspect: 1.5,
  });

let engine: SplatEngine;
let cloud: SplatCloud;
/** What a frame of so many splats is told to take. */
let msOf: (splats: number) => number;
beforeAll(async () => {
  engine = await SplatEngine.create({ device: await shareTestDevice(), accuracy: 'high' });
  cloud = engine.add(SET);
});
beforeEach(() => {
  msOf = (splats) => splats;
});

/** Real times of so few splats are noise. */
const { read } = GpuTimer.prototype;
vi.spyOn(GpuTimer.prototype, 'read').mockImplementation(async function (this: GpuTimer, ...args) {
  const statistics = await read.apply(this, args);
  if (!statistics) return null;
  const timing = { ...statistics.timing, ...wallClockTimings(msOf(statistics.visibleSplats)) };
  return { ...statistics, timing };
});
afterAll(() => vi.restoreAllMocks());

function draw(view: SplatView, detail: Detail, distance: number, force = false): void {
  view.render({
    camera: camera(distance),
    clouds: [{ cloud, effects: [antialias(true)] }],
    ...SIZE,
    detail,
    force,
  });
}

/** Keeps pictures from coming to rest while a test looks at one that moves, however slow the machine. */
function holdRest(): { release(): void } {
  const { setTimeout, clearTimeout } = globalThis;
  const held = new Map<unknown, () => void>();
  const set = vi.spyOn(globalThis, 'setTimeout').mockImplementation(((run: () => void, ms?: number) => {
    if (ms !== RESTS_AFTER_MS) return setTimeout(run, ms);
    const timer = setTimeout(() => {}, 0);
    held.set(timer, run);
    return timer;
  }) as typeof setTimeout);
  const clear = vi.spyOn(globalThis, 'clearTimeout').mockImplementation((timer) => {
    held.delete(timer);
    clearTimeout(timer);
  });
  return {
    release: () => {
      for (const spy of [set, clear]) spy.mockRestore();
      for (const run of held.values()) run();
    },
  };
}

/** Pixels of the view's last image, against the full ones that `reference` has. */
async function decibelsOf(view: SplatView, distance: number): Promise<number> {
  const full = engine.createView();
  full.render({
    camera: camera(distance),
    clouds: [{ cloud, effects: [antialias(true)] }],
    ...SIZE,
    accuracy: 'reference',
  });
  const [actual, expected] = [await view.readPixels(), await full.readPixels()];
  full.destroy();
  return compareImages(actual.data, expected.data, SIZE).psnrDb;
}

describe('minPsnrDb', () => {
  gpuTest('is kept by the picture at rest, with fewer splats than all, and told', async () => {
    const view = engine.createView();
    for (const [distance, minPsnrDb] of [
      [6, 35],
      [12, 40],
      [24, 30],
    ] as const) {
      const rest = holdRest();
      draw(view, { minPsnrDb }, distance);
      await view.whenDrawn();
      expect(view.detail!.isComplete).toBe(false);
      rest.release();
      await view.whenComplete();
      const { asked, drawn, measuredPsnrDb, predictedPsnrDb, isComplete } = view.detail!;
      expect({ asked, isComplete }).toEqual({ asked: { minPsnrDb }, isComplete: true });
      expect(measuredPsnrDb).toBeGreaterThanOrEqual(minPsnrDb);
      expect(await decibelsOf(view, distance)).toBeCloseTo(measuredPsnrDb!, 1);
      expect(drawn).not.toBe('full');
      expect(predictedPsnrDb).toBeCloseTo(measuredPsnrDb!, 1);
    }
    view.destroy();
  });

  gpuTest('draws all splats where fewer take longer', async () => {
    msOf = (splats) => 1 / splats;
    const view = engine.createView();
    draw(view, { minPsnrDb: 30 }, 12);
    await view.whenComplete();
    expect(view.detail).toMatchObject({ drawn: 'full', isComplete: true });
    expect(view.detail!.measuredPsnrDb).toBeGreaterThan(60);
    view.destroy();
  });

  gpuTest('draws all splats where no fewer reach it', async () => {
    const view = engine.createView();
    draw(view, { minPsnrDb: 200 }, 3);
    await view.whenComplete();
    expect(view.detail).toMatchObject({ drawn: 'full', isComplete: true });
    expect(view.detail!.measuredPsnrDb).toBeGreaterThan(60);
    view.destroy();
  });

  gpuTest('is predicted while something moves, by what was measured before', async () => {
    const view = engine.createView();
    draw(view, { minPsnrDb: 30 }, 10);
    await view.whenComplete();
    const rest = holdRest();
    draw(view, { minPsnrDb: 30 }, 9);
    await view.whenDrawn();
    const { drawn, measuredPsnrDb, predictedPsnrDb } = view.detail!;
    expect(drawn).not.toBe('full');
    expect(measuredPsnrDb).toBeNull();
    // Three more, and six for each factor of two in size.
    expect(predictedPsnrDb).toBeCloseTo(33 + 6 * Math.log2(10 / 9), 3);
    expect(Math.abs((await decibelsOf(view, 9)) - predictedPsnrDb!)).toBeLessThan(5);
    rest.release();
    view.destroy();
  });

  gpuTest('is predicted anew from where something moves', async () => {
    const view = engine.createView();
    draw(view, { minPsnrDb: 45 }, 6);
    await view.whenComplete();
    const rest = holdRest();
    let distance = 8;
    // Frames move to and fro until a prediction has begun and ended. On a busy machine that takes
    // seconds, after which frames that had moved on would be far from where it was made.
    await expect
      .poll(async () => {
        distance = distance === 8 ? 8.01 : 8;
        draw(view, { minPsnrDb: 45 }, distance);
        await view.whenDrawn();
        return view.detail!.predictedPsnrDb;
      })
      // Three more. Before, as much more for the distance as six for each factor of two.
      .toBeLessThan(48.2);
    const { drawn, predictedPsnrDb, measuredPsnrDb } = view.detail!;
    expect(drawn).not.toBe('full');
    expect(measuredPsnrDb).toBeNull();
    const psnrDb = await decibelsOf(view, distance);
    expect(psnrDb).toBeGreaterThan(45);
    expect(Math.abs(psnrDb - predictedPsnrDb!)).toBeLessThan(5);
    rest.release();
    view.destroy();
  });

  gpuTest('is kept by instances, near ones and far ones together', async () => {
    const at = (x: number, z: number) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, z, 1];
    const instances = { modelMatrices: [at(0, 0), at(-4, -8), at(6, -20), at(1, 1e3)].flat() };
    const request = {
      camera: camera(8),
      ...SIZE,
      clouds: [{ cloud, instances, effects: [antialias(true)] }],
    };
    const [view, full] = [engine.createView(), engine.createView()];
    view.render({ ...request, detail: { minPsnrDb: 35 } });
    await view.whenComplete();
    expect(view.detail!.drawn).not.toBe('full');
    full.render({ ...request, accuracy: 'reference' });
    const [actual, expected] = [await view.readPixels(), await full.readPixels()];
    expect(compareImages(actual.data, expected.data, SIZE).psnrDb).toBeGreaterThan(34.5);
    for (const each of [view, full]) each.destroy();
  });

  gpuTest('is not measured where nothing can be cut, and nothing is concluded from that', async () => {
    // Flat, without any extent along z.
    const modelMatrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1];
    const view = engine.createView();
    const request = { camera: camera(12), ...SIZE, detail: { minPsnrDb: 30 } };
    view.render({ ...request, clouds: [{ cloud, modelMatrix }] });
    await view.whenComplete();
    expect(view.detail).toMatchObject({ drawn: 'full', isComplete: true, predictedPsnrDb: null });
    const rest = holdRest();
    view.render({ ...request, camera: camera(11), clouds: [{ cloud }] });
    await view.whenDrawn();
    expect(view.detail!.drawn).toBe('full');
    rest.release();
    view.destroy();
  });

  gpuTest('is full, and told, where it cannot be measured', async () => {
    const warn = vi.spyOn(console, 'warn').mockImplementation(() => {});
    const view = engine.createView();
    const { createView } = engine;
    engine.createView = () => {
      throw new Error('There is no memory for another view.');
    };
    draw(view, { minPsnrDb: 30 }, 12);
    await view.whenComplete();
    engine.createView = createView;
    expect(view.detail).toMatchObject({ drawn: 'full', isComplete: true, measuredPsnrDb: null });
    expect(warn).toHaveBeenCalledExactlyOnceWith(expect.stringContaining('no memory for another view'));
    warn.mockRestore();
    view.destroy();
  });

  gpuTest('is found for a picture that rests already, and left again', async () => {
    const view = engine.createView();
    draw(view, 'full', 12);
    await view.whenComplete();
    expect(view.detail).toMatchObject({ drawn: 'full', isComplete: true, measuredPsnrDb: null });
    draw(view, { minPsnrDb: 30 }, 12);
    await view.whenComplete();
    expect(view.detail!.drawn).not.toBe('full');
    expect(view.detail!.measuredPsnrDb).toBeGreaterThanOrEqual(30);
    draw(view, 'full', 12);
    await view.whenComplete();
    expect(view.detail).toMatchObject({
      asked: 'full',
      drawn: 'full',
      isComplete: true,
      measuredPsnrDb: null,
    });
    view.destroy();
  });

  gpuTest('ends with the view: no wait is left, and nothing is drawn', async () => {
    const view = engine.createView();
    draw(view, { minPsnrDb: 40 }, 8);
    await view.whenDrawn();
    const complete = Promise.allSettled([view.whenComplete()]);
    const { framesDrawn } = engine.counters();
    view.destroy();
    await complete;
    expect(engine.counters().framesDrawn).toBe(framesDrawn);
  });
});

describe('maxFrameMs', () => {
  /** Draws moving frames until the view has as few splats as it may have. */
  async function move(view: SplatView, detail: Detail): Promise<void> {
    for (let frame = 0; frame < 60; frame++) {
      draw(view, detail, 4 + 0.01 * frame, true);
      await view.whenDrawn();
      await engine.device.queue.onSubmittedWorkDone();
      const { drawn } = view.detail!;
      if (drawn !== 'full' && drawn.maxSplats! <= 1000) return;
    }
    throw new Error(`Frames stay at ${JSON.stringify(view.detail!.drawn)}.`);
  }

  gpuTest('draws fewer splats while the camera moves, and all at rest', async () => {
    const view = engine.createView();
    const detail = { maxFrameMs: NEVER_MS };
    const rest = holdRest();
    await move(view, detail);
    const moving = await decibelsOf(view, 4);
    expect(moving).toBeLessThan(40);
    rest.release();
    await view.whenComplete();
    expect(view.detail).toMatchObject({ drawn: 'full', isComplete: true, measuredPsnrDb: null });
    const again = holdRest();
    draw(view, detail, 9);
    await view.whenDrawn();
    expect(view.detail!.drawn).toEqual({ maxSplats: 1000 });
    again.release();
    view.destroy();
  });

  gpuTest(
    'draws a quarter of the pixels while the camera moves where they take too long, and all at rest',
    async () => {
      const pace = vi
        .spyOn(FramePace.prototype, 'moving', 'get')
        .mockReturnValue({ detail: 'full', movingScale: 0.5 });
      const [view, other] = [engine.createView(), engine.createView()];
      draw(view, { maxFrameMs: NEVER_MS }, 4);
      await view.whenComplete();
      const rest = holdRest();
      draw(view, { maxFrameMs: NEVER_MS }, 4.2);
      await view.whenDrawn();
      expect(view.detail).toMatchObject({ drawn: 'full', movingScale: 0.5, isComplete: false });
      const request = { camera: camera(4.2), clouds: [{ cloud, effects: [antialias(true)] }], ...SIZE };
      other.render({ ...request, accuracy: { resolutionScale: 0.5 } });
      expect((await view.readPixels()).data).toEqual((await other.readPixels()).data);
      rest.release();
      await view.whenComplete();
      expect(view.detail).toMatchObject({ drawn: 'full', movingScale: 1, isComplete: true });
      other.render(request);
      expect((await view.readPixels()).data).toEqual((await other.readPixels()).data);
      pace.mockRestore();
      for (const each of [view, other]) each.destroy();
    },
  );

  gpuTest('makes levels as soon as a picture at rest was too slow, before anything moves', async () => {
    const own = engine.add(SET);
    const view = engine.createView();
    view.render({ camera: camera(8), clouds: [{ cloud: own }], ...SIZE, detail: { maxFrameMs: NEVER_MS } });
    await view.whenComplete();
    await expect.poll(() => own.levels).not.toBeNull();
    expect(view.detail!.drawn).toBe('full');
    view.destroy();
    own.destroy();
  });

  gpuTest('draws all splats, without levels, where that is in time', async () => {
    const own = engine.add(SET);
    const view = engine.createView();
    for (let frame = 0; frame < 5; frame++) {
      const clouds = [{ cloud: own }];
      view.render({ camera: camera(8 + frame), clouds, ...SIZE, detail: { maxFrameMs: 1e6 } });
      await view.whenDrawn();
      await engine.device.queue.onSubmittedWorkDone();
      expect(view.detail!.drawn).toBe('full');
    }
    expect(own.levels).toBeNull();
    view.destroy();
    own.destroy();
  });

  gpuTest('is that of the accuracy for `auto`', async () => {
    const view = engine.createView();
    const request = {
      clouds: [{ cloud }],
      ...SIZE,
      detail: 'auto',
      accuracy: { maxFrameMs: NEVER_MS },
    } as const;
    const rest = holdRest();
    await expect
      .poll(async () => {
        view.render({ ...request, camera: camera(8), force: true });
        await view.whenDrawn();
        return view.detail!.drawn;
      })
      .toEqual({ maxSplats: 1000 });
    rest.release();
    view.destroy();
  });
});

describe('limits', () => {
  gpuTest('are drawn as asked, and complete at once', async () => {
    const view = engine.createView();
    draw(view, { maxShare: 0.25 }, 8);
    await view.whenComplete();
    expect(view.detail).toEqual({
      asked: { maxShare: 0.25 },
      drawn: { maxShare: 0.25 },
      movingScale: 1,
      predictedPsnrDb: null,
      measuredPsnrDb: null,
      isComplete: true,
      missing: 0,
    });
    await expect.poll(() => view.statistics?.visibleSplats).toBeLessThanOrEqual(SET.count / 4);
    view.destroy();
  });
});
