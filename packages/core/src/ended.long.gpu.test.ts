// Proves: public functions answer, or throw errors of their own, after any end; listeners that throw keep
// nothing.
import { createTestDevice, gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import type { SplatCloud } from './clouds/splat-cloud.ts';
import { SplatEngine } from './create-engine.ts';
import { perspectiveCamera } from './data/camera/camera.ts';
import { WebSplatterError } from './data/errors.ts';
import { followEdits } from './features/edits/edits.clouds.ts';
import { SplatEdits } from './features/edits/splat-edits.data.ts';
import { write } from './io/formats/bricks/write-bricks.ts';
import { randomSplats } from './testing/random-splats.ts';
import { reportedErrors } from './testing/reported-errors.ts';
import { testGpu } from './testing/test-gpu.ts';

const SET = randomSplats({ count: 600, seed: 1, shDegree: 1 });
const SIZE = { widthPx: 32, heightPx: 32 };
const CAMERA = perspectiveCamera({
  position: [0, 0, 3],
  target: [0, 0, 0],
  fovYDegrees: 60,
  aspect: 1,
});

const gpu = testGpu();

const NO_MEMORY = {
  ...{ totalBytes: 0, resources: [] },
  scene: { totalBytes: 0, clouds: [] },
  frames: { totalBytes: 0, views: [] },
};

/** An engine with all that it can hold, and what was made of it. */
async function full(device = gpu.device) {
  const engine = await SplatEngine.create({ device });
  const clouds: SplatCloud[] = [
    engine.add(SET, { name: 'plain' }),
    engine.add(SET, { name: 'edited' }),
    await engine.load(new File([await write(SET, {})], 'a.bricks')),
  ];
  const edits = new SplatEdits();
  await followEdits(clouds[1], edits);
  edits.set({ first: 0, count: 3 }, { colors: [1, 0, 0] });
  await clouds[0].makeLevels();
  const view = engine.createView();
  const embedded = engine.createEmbeddedView();
  const request = { camera: CAMERA, clouds: clouds.map((cloud) => ({ cloud })), ...SIZE };
  view.render(request);
  await view.whenComplete();
  return { engine, clouds, edits, view, embedded, request };
}

type Full = Awaited<ReturnType<typeof full>>;

/** Calls of everything that is public. */
function callsOf({ engine, clouds, edits, view, embedded, request }: Full): Record<string, () => unknown> {
  const precision = { geometryPrecision: 'f32', shPrecision: 'f32' } as const;
  const calls: Record<string, () => unknown> = {
    accuracy: () => engine.accuracy,
    notices: () => engine.notices,
    setAccuracy: () => engine.setAccuracy('fast'),
    resolveAccuracy: () => engine.resolveAccuracy('fast'),
    load: () => engine.load(new Blob([])),
    add: () => engine.add(SET),
    createView: () => engine.createView(),
    createEmbeddedView: () => engine.createEmbeddedView(),
    effects: () => engine.effects(),
    drawnAccuracy: () => engine.drawnAccuracy(),
    clouds: () => engine.clouds,
    memory: () => engine.memory(),
    counters: () => engine.counters(),
    lost: () => engine.adapterLabel,
    'edits.set': () => edits.set({ first: 0, count: 3 }, { colors: [0, 1, 0] }),
    'edits.reset': () => edits.reset(),
    'view.render': () => view.render(request),
    'view.whenDrawn': () => view.whenDrawn(),
    'view.whenComplete': () => view.whenComplete(),
    'view.readPixels': () => view.readPixels(),
    'view.pick': () => view.pick(1, 1),
    'view.coverage': () => view.coverage([{ position: [0, 0, 0] }] as never),
    'view.chooseAccuracy': () => view.chooseAccuracy(),
    'view.statistics': () => view.statistics,
    'view.accuracyChoice': () => view.accuracyChoice,
    'view.detail': () => view.detail,
    'view.effects': () => view.effects(),
    'view.rasterizer': () => view.rasterizer,
    'view.shape': () => view.shape,
    'embedded.prepare': () => embedded.prepare(request),
    'embedded.draw': () => embedded.draw({ beginRenderPass: () => {} } as never, {} as never),
    'embedded.pick': () => embedded.pick(1, 1),
    'embedded.detail': () => embedded.detail,
    'embedded.effects': () => embedded.effects(),
  };
  for (const cloud of clouds)
    Object.assign(calls, {
      [`${cloud.name}.hold`]: () => cloud.hold(precision).met,
      [`${cloud.name}.precisions`]: () => cloud.precisions,
      [`${cloud.name}.ownLease`]: () => cloud.ownLease.change(precision),
      [`${cloud.name}.requestPrecision`]: () => engine.requestPrecision(cloud, precision),
      [`${cloud.name}.makeLevels`]: () => cloud.makeLevels(),
      [`${cloud.name}.bytes`]: () => cloud.bytes,
      [`${cloud.name}.pagesFor`]: () => cloud.pagesFor(precision),
      [`${cloud.name}.uploaded`]: () => cloud.uploaded,
      [`${cloud.name}.follow`]: () => followEdits(cloud, new SplatEdits()),
      [`${cloud.name}.report`]: () => cloud.stream?.report(),
      [`${cloud.name}.subscribe`]: () => cloud.stream?.subscribe(() => {})(),
      [`${cloud.name}.retry`]: () => cloud.stream?.retry(),
    });
  return calls;
}

/** Expects each call to return something, or to throw an error of this library. */
async function expectAnswers(all: Full): Promise<void> {
  const wrong: string[] = [];
  for (const [name, call] of Object.entries(callsOf(all))) {
    try {
      await call();
    } catch (error) {
      if (!(error instanceof WebSplatterError)) wrong.push(`${name}: ${(error as Error).stack}`);
    }
  }
  expect(wrong).toEqual([]);
}

describe('after the end', () => {
  /**
   * @fault Devices and engines: any public function is called after the end of an engine, device, cloud or
   *   view
   * @consequence an answer, or an error of this library; `memory()` of a lost device is 0
   */
  gpuTest.each(['engine', 'device', 'device, then engine', 'clouds', 'views'])(
    'of the %s, all answer or throw errors of their own',
    async (end) => {
      const device = end.startsWith('device') ? await createTestDevice() : undefined;
      const all = await full(device);
      const { engine, clouds, view, embedded } = all;
      if (device) {
        device.destroy();
        await engine.lost;
        expect(engine.memory()).toMatchObject(NO_MEMORY);
        await expectAnswers(all);
      }
      if (end.endsWith('engine')) {
        engine.destroy();
        await null;
        expect(engine.memory()).toMatchObject(NO_MEMORY);
      }
      if (end === 'clouds') for (const cloud of clouds) cloud.destroy();
      if (end === 'views') for (const each of [view, embedded]) each.destroy();
      await expectAnswers(all);
      for (const each of [view, embedded, ...clouds, engine]) each.destroy();
      await null;
      await expectAnswers(all);
      expect(engine.memory()).toMatchObject(NO_MEMORY);
    },
  );
});

/** @fault Listeners: a listener of a stream throws */
gpuTest('listeners that throw keep nothing from its end', async () => {
  const reported = reportedErrors();
  const error = new Error('of a listener');
  const bad = () => {
    throw error;
  };
  const all = await full();
  const { engine, clouds, view, embedded, request } = all;
  clouds[2].stream!.subscribe(bad);
  Object.assign(view, { onStatistics: bad, onAccuracyChosen: bad });
  Object.assign(embedded, { onReady: bad });
  embedded.prepare(request);
  view.render({ ...request, camera: { ...CAMERA }, background: [1, 0, 0] });
  await view.whenComplete();
  await expect.poll(() => reported.length).toBeGreaterThan(0);
  for (const each of [view, embedded, clouds[2], clouds[0], engine]) each.destroy();
  await null;
  expect(engine.memory().totalBytes).toBe(0);
  expect(new Set(reported)).toEqual(new Set([error]));
});
