// Proves: all waiting work is rejected when a cloud, view, engine or device ends.
import { collectGarbage } from '@websplatter/node/collect-garbage';
import { createTestDevice, gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import type { SplatCloud } from './clouds/splat-cloud.ts';
import { createEngine, SplatEngine } from './create-engine.ts';
import { perspectiveCamera } from './data/camera/camera.ts';
import { DestroyedError, InvalidArgumentError } from './data/errors.ts';
import { followEdits } from './features/edits/edits.clouds.ts';
import { SplatEdits } from './features/edits/splat-edits.data.ts';
import { encodePly } from './io/formats/ply/write-ply.ts';
import { deviceWith } from './testing/device-with.ts';
import { prepared } from './testing/prepared.ts';
import { randomSplats } from './testing/random-splats.ts';
import { seededRandom } from './testing/seeded-random.ts';
import { signalOf } from './testing/signal.ts';
import { testGpu } from './testing/test-gpu.ts';

const SIZE = { widthPx: 48, heightPx: 48 };
const SET = randomSplats({ count: 2000, seed: 4, shDegree: 1 });
const ROWS = encodePly(SET);
/** Images are compared bit for bit: their rasteriser must not follow from times. */
const ACCURACY = { preset: 'balanced', rasterizer: 'tiles' } as const;

function cameraAt(x: number) {
  return perspectiveCamera({ position: [x, 0, 4], target: [0, 0, 0], fovYDegrees: 45, aspect: 1 });
}

const gpu = testGpu();

function newEngine(onto = gpu.device): Promise<SplatEngine> {
  return createEngine({ device: onto, accuracy: ACCURACY }, { ingestMinRows: 1 });
}

async function imageOf(engine: SplatEngine): Promise<Float32Array> {
  const view = engine.createView();
  view.render({ camera: cameraAt(1), clouds: [{ cloud: engine.add(SET) }], ...SIZE });
  return (await view.readPixels()).data;
}

/** A file that begins and never goes on. */
function endlessFile() {
  const [read, dropped] = [signalOf(), signalOf()];
  const stream = new ReadableStream<Uint8Array>({
    start: (controller) => controller.enqueue(ROWS.slice(0, ROWS.length / 2)),
    pull: () => {
      read.give();
      return new Promise(() => {});
    },
    cancel: dropped.give,
  });
  return { stream, whenRead: read.when, whenDropped: dropped.when };
}

describe('work that waits for a frame', () => {
  /**
   * @fault Devices and engines: a cloud, view or engine ends while shaders compile
   * @consequence `whenDrawn` rejects with a `DestroyedError`
   */
  gpuTest('is told where a cloud, the view or the engine ends before the shaders are there', async () => {
    const own = await createTestDevice();
    const engine = await newEngine(own);
    const [dead, alive] = [engine.add(SET, { name: 'dead' }), engine.add(SET)];
    const [first, second, third] = [engine.createView(), engine.createView(), engine.createView()];
    const frame = { camera: cameraAt(0), ...SIZE };
    first.render({ ...frame, clouds: [{ cloud: dead }] });
    const outcome = expect(first.whenDrawn()).rejects.toThrow(/The cloud dead can no longer be used/);
    second.render({ ...frame, clouds: [{ cloud: dead }] });
    // A later request takes its place.
    second.render({ ...frame, clouds: [{ cloud: alive }] });
    const replaced = second.whenDrawn();
    third.render({ ...frame, clouds: [{ cloud: alive }] });
    const ended = expect(third.readPixels()).rejects.toThrow(DestroyedError);
    third.destroy();
    dead.destroy();
    await Promise.all([outcome, replaced, ended]);
    expect(engine.counters().framesDrawn).toBe(1);
    engine.destroy();
    own.destroy();
  });
});

/** The device that tells of no error, and of no lack of one, until `go`. */
function withLateAnswers(go: Promise<void>): { readonly late: GPUDevice; readonly whenAsked: Promise<void> } {
  const asked = signalOf();
  const popErrorScope = () => {
    const answer = gpu.device.popErrorScope();
    asked.give();
    return go.then(() => answer);
  };
  return { late: deviceWith(gpu.device, { popErrorScope }), whenAsked: asked.when };
}

/**
 * @fault Devices and engines: the device or the engine ends, or a load is aborted, while its cloud is
 *   uploaded
 * @consequence `DestroyedError`, or the signal's reason; no cloud is held
 */
describe('a load that ends while its cloud is uploaded', () => {
  for (const end of ['signal', 'engine'] as const) {
    gpuTest(`by the ${end} keeps nothing`, async () => {
      const go = signalOf();
      const { late, whenAsked } = withLateAnswers(go.when);
      const engine = await SplatEngine.create({ device: late });
      const [caller, reason] = [new AbortController(), new Error('enough')];
      const loading = engine.load(ROWS, { signal: caller.signal });
      await whenAsked;
      if (end === 'signal') caller.abort(reason);
      else engine.destroy();
      go.give();
      if (end === 'signal') await expect(loading).rejects.toBe(reason);
      else await expect(loading).rejects.toThrow(DestroyedError);
      expect(engine.memory()).toMatchObject({ totalBytes: 0, scene: { clouds: [] } });
      engine.destroy();
    });
  }
});

gpuTest('a value that is no source is refused by name', async () => {
  const engine = await newEngine();
  for (const wrong of [null, undefined])
    await expect(engine.load(wrong as never)).rejects.toThrow(InvalidArgumentError);
  engine.destroy();
});

describe('an engine', () => {
  gpuTest('that is held keeps nothing that was destroyed', async () => {
    const engine = await newEngine();
    const frame = { camera: cameraAt(0), ...SIZE };
    const made = async () => {
      const view = engine.createView();
      const clouds = [engine.add(SET), await engine.load(new Blob([ROWS])), await engine.load(ROWS.slice())];
      const edits = new SplatEdits();
      await followEdits(clouds[0], edits);
      edits.set({ first: 0, count: 3 }, { colors: [1, 0, 0] });
      await clouds[1].makeLevels();
      await engine.requestPrecision(clouds[1], { geometryPrecision: 'f32', shPrecision: 'f32' });
      for (const detail of ['full', { maxErrorPx: 1 }] as const) {
        view.render({ ...frame, clouds: clouds.map((cloud) => ({ cloud })), detail });
        await view.readPixels();
        await view.pick(20, 20);
      }
      await view.whenComplete();
      view.destroy();
      for (const cloud of clouds) cloud.destroy();
      return [view, ...clouds, edits].map((each) => new WeakRef<object>(each));
    };
    const left = await made();
    await collectGarbage();
    expect(left.filter((each) => each.deref() !== undefined)).toEqual([]);
    engine.destroy();
  });
});

describe('the end of an engine', () => {
  /**
   * @fault Devices and engines: the device or the engine ends during a load
   * @consequence `DestroyedError`; the stream is cancelled, worker and memory are freed
   */
  gpuTest.each(['engine', 'device'] as const)('ends what it loads: %s', async (end) => {
    const own = await createTestDevice();
    const engine = await newEngine(own);
    const { stream, whenRead, whenDropped } = endlessFile();
    const rejected = expect(engine.load(stream)).rejects.toThrow(DestroyedError);
    await whenRead;
    if (end === 'engine') engine.destroy();
    else own.destroy();
    await Promise.all([rejected, whenDropped]);
    expect(engine.memory().totalBytes).toBe(0);
    own.destroy();
  });

  /**
   * @fault Devices and engines: the engine of a cloud ends, and another on the same device draws the cloud
   * @consequence `DestroyedError` that names the cloud; `memory()` of the ended engine is 0
   */
  gpuTest('ends its clouds, which no engine on the same device draws any more', async () => {
    const [ended, other] = [await newEngine(), await newEngine()];
    const cloud = ended.add(SET, { name: 'garden' });
    await cloud.uploaded;
    const view = other.createView();
    ended.destroy();
    const draw = () => view.render({ camera: cameraAt(1), clouds: [{ cloud }], ...SIZE });
    expect(draw).toThrow('The cloud garden can no longer be used: its engine was destroyed.');
    expect(draw).toThrow(DestroyedError);
    expect(cloud).toMatchObject({ isDestroyed: true, bytes: 0 });
    await Promise.resolve();
    expect(ended.memory()).toMatchObject({ totalBytes: 0, scene: { totalBytes: 0, clouds: [] } });
    cloud.destroy();
    other.destroy();
  });

  /**
   * @fault Devices and engines: engines, views, clouds and edits come and go while their device lives on
   * @consequence JavaScript holds no ended object
   */
  gpuTest('leaves nothing of it in memory, though its device is held', async () => {
    const drawn = async () => {
      const engine = await newEngine();
      await imageOf(engine);
      engine.destroy();
      return new WeakRef(engine);
    };
    const ended = await drawn();
    await collectGarbage();
    expect(ended.deref()).toBeUndefined();
  });

  /**
   * @fault Devices and engines: the engine ends after a host has recorded its splats
   * @consequence the host's submission stays valid; a further `draw` throws a `DestroyedError`
   */
  gpuTest('leaves the commands that a host has recorded valid', async () => {
    const engine = await newEngine();
    const view = engine.createEmbeddedView();
    const frame = { camera: cameraAt(0), clouds: [{ cloud: engine.add(SET) }], ...SIZE };
    await prepared(view, frame);
    const color = gpu.device.createTexture({
      size: [SIZE.widthPx, SIZE.heightPx],
      format: 'rgba16float',
      usage: GPUTextureUsage.TEXTURE_BINDING,
    });
    const pass = { color, depth: null, xPx: 0, yPx: 0 };
    const encoder = gpu.device.createCommandEncoder();
    view.draw(encoder, pass);
    engine.destroy();
    expect(() => view.draw(encoder, pass)).toThrow(DestroyedError);
    gpu.device.queue.submit([encoder.finish()]);
    color.destroy();
  });
});

/** The seed of the first round; each further round has the next. */
const SEED = Number(process.env.WEBSPLATTER_SEED ?? 1);
const ROUNDS = 16;
/** Longest time that a round runs, in turns of the event loop. */
const MOST_TURNS = 400;

function nextTurn(): Promise<void> {
  return new Promise((resolve) => setImmediate(resolve));
}

/** All that an engine does, at once and again until it ends. Returns each work's rejection. */
function busyWork(engine: SplatEngine, random: () => number): Promise<unknown>[] {
  const [view, targeting] = [engine.createView(), engine.createView()];
  const cloud = engine.add(SET);
  const shown = { cloud: cloud as SplatCloud };
  const frameAt = (sizePx: number) => ({
    camera: cameraAt(random()),
    clouds: [{ cloud: shown.cloud.isDestroyed ? cloud : shown.cloud }],
    widthPx: sizePx,
    heightPx: sizePx,
  });
  const works: (() => Promise<unknown>)[] = [
    async () => {
      const loaded = await engine.load(new Blob([ROWS]), {
        onPreview: (preview) => {
          shown.cloud = preview;
        },
      });
      loaded.destroy();
    },
    async () => {
      view.render(frameAt(16 + Math.floor(32 * random())));
      await view.readPixels();
    },
    async () => {
      view.render({ ...frameAt(48), clouds: [{ cloud }] });
      await view.pick(24, 24);
    },
    async () => {
      const shPrecision = random() < 0.5 ? 'u8' : 'f16';
      await engine.requestPrecision(cloud, { geometryPrecision: 'f32', shPrecision });
    },
    async () => {
      targeting.render({ ...frameAt(48), clouds: [{ cloud }], accuracy: { minPsnrDb: 45 } });
      await targeting.chooseAccuracy();
    },
    async () => {
      const embedded = engine.createEmbeddedView();
      embedded.prepare({ ...frameAt(48), clouds: [{ cloud }] });
      await nextTurn();
      embedded.destroy();
    },
  ];
  return works.map(async (work) => {
    try {
      for (;;) {
        await work();
        // Work that had nothing to do must not keep the others from theirs.
        await nextTurn();
      }
    } catch (error) {
      return error;
    }
  });
}

describe(`the end at any moment, of ${ROUNDS} rounds`, () => {
  for (let seed = SEED; seed < SEED + ROUNDS; seed++) {
    // A device that is lost takes its shaders with it: few of these rounds get beyond compiling.
    const end = seed % 4 === 0 ? 'device' : 'engine';
    /**
     * @fault Devices and engines: the engine or the device ends at any moment
     * @consequence all pending work rejects with a `DestroyedError`; no validation error
     */
    gpuTest(`${end}, seed ${seed}`, async () => {
      const random = seededRandom(seed);
      const own = end === 'device' ? await createTestDevice() : gpu.device;
      const engine = await newEngine(own);
      const work = busyWork(engine, random);
      const turns = Math.floor(MOST_TURNS * random() ** 2);
      for (let turn = 0; turn < turns; turn++) await nextTurn();
      if (end === 'engine') engine.destroy();
      else own.destroy();
      for (const error of await Promise.all(work)) expect(error).toBeInstanceOf(DestroyedError);
      if (end === 'engine') expect(engine.memory().totalBytes).toBe(0);
      else await engine.lost;
      engine.destroy();
    });
  }

  gpuTest('and the next engine draws as the first did', async () => {
    const [used, fresh] = [await newEngine(), await newEngine(await createTestDevice())];
    expect(await imageOf(used)).toEqual(await imageOf(fresh));
    for (const engine of [used, fresh]) engine.destroy();
  });
});
