// Proves: a target is measured, met and kept by views that share it.
import { gpuTest, sharedTestGpu, watchDevice } from '@websplatter/node/gpu-test';
import { afterAll, afterEach, beforeAll, beforeEach, describe, expect, vi } from 'vitest';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { SplatEngine } from '../create-engine.ts';
import { perspectiveCamera } from '../data/camera/camera.ts';
import { DestroyedError } from '../data/errors.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import type { AccuracyChoice } from '../measure/choose-accuracy.ts';
import { compareViews } from '../measure/compare-views.ts';
import { randomSplats } from '../testing/random-splats.ts';

const SIZE = { widthPx: 64, heightPx: 64 };
const TARGET = { minPsnrDb: 45 };

let engine: SplatEngine;
let cloud: SplatCloud;

beforeAll(async () => {
  const adapter = await sharedTestGpu.requestAdapter();
  engine = await SplatEngine.create({ adapter });
  watchDevice(engine.device);
  cloud = engine.add(randomSplats({ count: 300, shDegree: 1 }));
});
afterAll(() => engine?.destroy());

function cameraAt(x: number) {
  return perspectiveCamera({ position: [x, 0, 4], target: [0, 0, 0], fovYDegrees: 45, aspect: 1 });
}

function frameOf(clouds: readonly SplatCloud[], x = 0): FrameRequest {
  return { camera: cameraAt(x), clouds: clouds.map((each) => ({ cloud: each })), ...SIZE, accuracy: TARGET };
}

describe('a view with a target', () => {
  const warn = vi.spyOn(console, 'warn');
  beforeEach(() => void warn.mockClear());
  afterEach(() => expect(warn).not.toHaveBeenCalled());

  gpuTest(
    'chooses automatically, keeps the choice while the camera moves, and chooses again for other clouds',
    async () => {
      const view = engine.createView();
      const told: AccuracyChoice[] = [];
      const next = () =>
        new Promise<AccuracyChoice>((resolve) => {
          view.onAccuracyChosen = (choice) => {
            told.push(choice);
            resolve(choice);
          };
        });
      const embedded = engine.createEmbeddedView();
      const embeddedTold = vi.fn();
      const onReady = vi.fn();
      embedded.onAccuracyChosen = embeddedTold;
      const first = next();
      view.render(frameOf([cloud]));
      embedded.onReady = () => embedded.prepare({ ...frameOf([cloud]), widthPx: 16, heightPx: 16 });
      embedded.onReady();
      await expect.poll(() => embedded.shape).not.toBeNull();
      embedded.onReady = onReady;
      expect(view.accuracyChoice).toBeNull();
      const choice = await first;
      expect(choice).toMatchObject({ target: TARGET, isMet: true });
      expect(choice.table.points.map(({ name }) => name)).not.toContain('paper −CULL');
      expect(view.accuracyChoice).toBe(choice);
      const { geometryPrecision, shPrecision } = choice.settings;
      await expect.poll(() => cloud.precisions).toEqual({ geometry: [geometryPrecision], sh: [shPrecision] });

      // Another view of the same clouds with the same target has the same choice.
      expect(embeddedTold.mock.calls).toEqual([[choice]]);
      expect(onReady).toHaveBeenCalledOnce();
      embedded.destroy();

      // The view has drawn its frame again, as close to the reference as the target requires.
      expect(view.render(frameOf([cloud]))).toBe(false);
      const planes = { geometryPrecision: 'f32', shPrecision: 'f32' } as const;
      const lease = cloud.hold(planes);
      await lease.met;
      const reference = engine.createView();
      reference.render({ ...frameOf([cloud]), accuracy: choice.table.reference.settings });
      expect((await compareViews(view, reference)).psnrDb).toBeGreaterThanOrEqual(TARGET.minPsnrDb);
      reference.destroy();
      lease.release();

      const before = engine.counters().framesDrawn;
      for (const x of [0.1, 0.2, 0.3]) view.render(frameOf([cloud], x));
      expect(engine.counters().framesDrawn).toBe(before + 3);
      expect(told).toEqual([choice]);

      const another = engine.add(randomSplats({ count: 100, seed: 2 }));
      const second = next();
      view.render(frameOf([cloud, another], 0.3));
      expect(view.accuracyChoice).toBe(choice);
      const { table, settings } = await second;
      expect(table.splats).toBe(400);
      expect(told).toHaveLength(2);
      // Clouds loaded by an engine with this target are packed for the choice.
      await engine.setAccuracy({ ...TARGET });
      expect(engine.accuracy).toBe(settings);
      await engine.setAccuracy('balanced');
      view.destroy();
      another.destroy();
    },
  );

  gpuTest('measures on request, and holds the planes for the choice', async () => {
    const view = engine.createView();
    view.render({ ...frameOf([cloud]), accuracy: { minPsnrDb: 200 } });
    const { settings, why } = await view.chooseAccuracy();
    expect(settings).toMatchObject({ geometryPrecision: 'f32', shPrecision: 'f32' });
    expect(why).toContain('an image identical to the reference');
    await expect.poll(() => cloud.precisions).toEqual({ geometry: ['f32'], sh: ['f32'] });
    view.destroy();
  });

  gpuTest('measures nothing for settings, and stops when its signal is aborted', async () => {
    const view = engine.createView();
    await expect(view.chooseAccuracy()).rejects.toThrow('without a target');
    view.render({ ...frameOf([cloud]), accuracy: 'fast' });
    await expect(view.chooseAccuracy()).rejects.toThrow('without a target');
    view.render(frameOf([cloud]));
    const ending = new AbortController();
    const calledOff = view.chooseAccuracy({
      signal: ending.signal,
      onProgress: () => ending.abort(new Error('enough')),
    });
    await expect(calledOff).rejects.toThrow('enough');
    view.destroy();
    await expect(view.chooseAccuracy()).rejects.toThrow(DestroyedError);
  });

  gpuTest('ends quietly with its view, its cloud and its engine', async () => {
    const adapter = await sharedTestGpu.requestAdapter();
    const own = await SplatEngine.create({ adapter, accuracy: TARGET });
    const clouds = [own.add(randomSplats({ count: 50 })), own.add(randomSplats({ count: 60 }))];
    const views = clouds.map(() => own.createView());
    const started = views.map(
      (view, i) =>
        new Promise<{ readonly choosing: Promise<AccuracyChoice> }>((resolve) => {
          view.render({ ...frameOf([clouds[i]]), accuracy: undefined });
          const choosing = view.chooseAccuracy({ onProgress: () => resolve({ choosing }) });
          // Awaited below.
          choosing.catch(() => {});
        }),
    );
    const first = await started[0];
    views[0].destroy();
    await expect(first.choosing).rejects.toThrow('No view shows');
    const second = await started[1];
    clouds[1].destroy();
    await expect(second.choosing).rejects.toThrow(DestroyedError);
    views[1].render({ ...frameOf([clouds[0]]), accuracy: undefined });
    const third = views[1].chooseAccuracy();
    own.destroy();
    await expect(third).rejects.toThrow(DestroyedError);
  });
});
