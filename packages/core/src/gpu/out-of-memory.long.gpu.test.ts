// Proves: any allocation may fail: earlier state stays, and the lack is reported.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { CloudPlanes } from '../clouds/cloud-planes.ts';
import { createEngine, SplatEngine } from '../create-engine.ts';
import type { Accuracy } from '../data/accuracy/accuracy.ts';
import { perspectiveCamera } from '../data/camera/camera.ts';
import { DestroyedError, GpuLimitError } from '../data/errors.ts';
import { packSet } from '../data/packing/pack-set.ts';
import { encodePly } from '../io/formats/ply/write-ply.ts';
import { deviceWith, limitsWith } from '../testing/device-with.ts';
import { type FailingDevice, failingDevice } from '../testing/failing-device.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { ScarceMemory } from '../testing/scarce-memory.ts';
import { signalOf } from '../testing/signal.ts';
import { volumes } from './effects/volumes/volumes.ts';
import type { TextureImage } from './read-texture.ts';

const SIZE = { widthPx: 32, heightPx: 24 };
const LARGE_SIZE = { widthPx: 80, heightPx: 48 };
const CAMERA = perspectiveCamera({ position: [0, 0, 5], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 });
const FEW = randomSplats({ count: 300, seed: 1, shDegree: 1 });
const MORE = randomSplats({ count: 700, seed: 2, shDegree: 1 });

let failing: FailingDevice;
beforeAll(async () => {
  failing = failingDevice(await shareTestDevice());
});

/**
 * Calls `attempt` with one allocation after another failing, or every `step`th, until none is left
 * to fail. `attempt` calls `stop` before it allocates for other purposes, which returns whether the
 * allocation has failed.
 */
async function failEach(attempt: (stop: () => boolean) => Promise<void>, step = 1): Promise<void> {
  let hasFailed = true;
  for (let n = 0; hasFailed; n += step) {
    failing.failAfter(n);
    await attempt(() => {
      hasFailed = failing.stop();
      return hasFailed;
    });
  }
}

/** What `promise` rejects with, which must be a lack of memory; null if it resolves. */
async function lackOf(promise: Promise<unknown>): Promise<GpuLimitError | null> {
  const error = await promise.then(
    () => null,
    (reason: unknown) => reason,
  );
  if (error === null) return null;
  expect(error).toBeInstanceOf(GpuLimitError);
  expect(error).toMatchObject({ limit: 'memory', availableBytes: 0 });
  expect((error as GpuLimitError).neededBytes).toBeGreaterThan(0);
  return error as GpuLimitError;
}

describe('an allocation that fails, whichever it is', () => {
  const all: readonly Accuracy[] = [
    { preset: 'fast', rasterizer: 'tiles', resolutionScale: 0.5 },
    { preset: 'fast', rasterizer: 'tiles', resolutionScale: 1 },
    { preset: 'fast', rasterizer: 'quads', resolutionScale: 0.5 },
    { preset: 'reference', rasterizer: 'quads', resolutionScale: 1 },
  ];
  const isFull = process.env.WEBSPLATTER_FULL === '1';
  // The short run lets every third allocation fail: successive ones of a part fail alike.
  const step = isFull ? 1 : 3;
  // The first has every part of a frame.
  for (const accuracy of isFull ? all : all.slice(0, 1)) {
    const { rasterizer, resolutionScale } = accuracy as { rasterizer: string; resolutionScale: number };
    /**
     * @fault GPU memory: any allocation of a frame finds no memory
     * @consequence `whenDrawn` and the next `render` give a `GpuLimitError` with the bytes. The last image
     *   stays. The frame is drawn as soon as there is memory
     */
    gpuTest(`of a frame by ${rasterizer} at scale ${resolutionScale}: the picture before stays`, async () => {
      const engine = await SplatEngine.create({ device: failing.device, accuracy });
      const small = { camera: CAMERA, clouds: [{ cloud: engine.add(FEW) }], ...SIZE };
      const large = { camera: CAMERA, clouds: [{ cloud: engine.add(MORE) }], ...LARGE_SIZE };
      const view = engine.createView();
      view.render(large);
      const expected = await view.readPixels();
      view.render(small);
      const before = await view.readPixels();
      const { totalBytes } = engine.memory();
      let failures = 0;
      await failEach(async (stop) => {
        view.render(large);
        const lack = await lackOf(view.whenDrawn());
        expect(stop()).toBe(lack !== null);
        if (!lack) return;
        failures++;
        expect(lack.heldBytes).toBe(totalBytes);
        await expect(view.readPixels()).rejects.toBe(lack);
        expect(() => view.render(large)).toThrow(lack);
        // The picture before is there again, and nothing else is counted.
        expect(view.render(small)).toBe(false);
        expect(await view.readPixels()).toEqual(before);
        expect(engine.memory().totalBytes).toBe(totalBytes);
        // The same size is tried again.
        expect(view.render(large)).toBe(false);
        expect(await view.readPixels()).toEqual(expected);
        view.render(small);
      }, step);
      expect(failures).toBeGreaterThan(20 / step);
      engine.destroy();
    });
  }

  /**
   * @fault GPU memory: an allocation of a frame by tiles that `auto` has chosen finds no memory
   * @consequence quads draw the frame; `view.rasterizer` says why
   */
  gpuTest('of a first frame by tiles that were not asked for: quads draw it', async () => {
    const engine = await SplatEngine.create({ device: failing.device });
    const request = { camera: CAMERA, clouds: [{ cloud: engine.add(FEW) }], ...SIZE };
    const first = engine.createView();
    first.render(request);
    const expected = await first.readPixels();
    first.destroy();
    const { totalBytes } = engine.memory();
    await failEach(async (stop) => {
      const view = engine.createView();
      view.render(request);
      await view.whenDrawn();
      // Quads take the place of tiles that find no memory, and the view says so.
      if (stop()) {
        const reason = expect.stringContaining('no memory');
        expect(view.rasterizer).toMatchObject({ rasterizer: 'quads', reason });
        expect(greatestDifference(await view.readPixels(), expected)).toBeLessThan(0.01);
      } else expect(await view.readPixels()).toEqual(expected);
      view.destroy();
    });
    expect(engine.memory().totalBytes).toBe(totalBytes);
    engine.destroy();
  });

  /**
   * @fault GPU memory: an allocation of a frame inside another renderer's finds no memory
   * @consequence `onReady` is called, `prepare` throws once, and the last splats are drawn
   */
  gpuTest('of a frame inside another: the host is told, and draws the splats before', async () => {
    const { device } = failing;
    const accuracy = { preset: 'fast', rasterizer: 'quads' } as const;
    const engine = await SplatEngine.create({ device, accuracy });
    const small = { camera: CAMERA, clouds: [{ cloud: engine.add(FEW) }], ...SIZE };
    const large = { ...small, clouds: [{ cloud: engine.add(MORE) }] };
    const view = engine.createEmbeddedView();
    let onReady = () => {};
    view.onReady = () => onReady();
    const whenReady = () => new Promise<void>((resolve) => (onReady = resolve));
    for (const request of [large, small]) while (!view.prepare(request)) await whenReady();
    await device.queue.onSubmittedWorkDone();
    const { totalBytes } = engine.memory();
    let failures = 0;
    await failEach(async (stop) => {
      const told = whenReady();
      expect(view.prepare(large)).toBe(true);
      if (!stop()) return;
      await told;
      failures++;
      expect(engine.memory().totalBytes).toBe(totalBytes);
      expect(() => view.prepare(large)).toThrow(GpuLimitError);
      // The splats before stand until there is memory.
      const found = whenReady();
      expect(view.prepare(large)).toBe(true);
      expect(view.shape?.clouds[0].cloud).toBe(small.clouds[0].cloud);
      await found;
      expect(view.prepare(large)).toBe(true);
      expect(view.shape?.clouds[0].cloud).toBe(large.clouds[0].cloud);
      expect(view.prepare(small)).toBe(true);
    });
    expect(failures).toBeGreaterThan(10);
    engine.destroy();
  });

  /**
   * @fault GPU memory: a cloud finds no memory
   * @consequence `cloud.uploaded` rejects, the cloud is destroyed, others are drawn as before
   */
  gpuTest('of a cloud: it is destroyed, and others are drawn as before', async () => {
    const engine = await SplatEngine.create({ device: failing.device });
    const small = { camera: CAMERA, clouds: [{ cloud: engine.add(FEW) }], ...SIZE };
    const view = engine.createView();
    view.render(small);
    const before = await view.readPixels();
    const { totalBytes } = engine.memory();
    let failures = 0;
    await failEach(async (stop) => {
      const cloud = engine.add(MORE, { name: 'more' });
      const hasFailed = stop();
      const request = { ...small, clouds: [...small.clouds, { cloud }] };
      view.render(request);
      const drawn = view.whenDrawn();
      const [lack, lackOfFrame] = await Promise.all([lackOf(cloud.uploaded), lackOf(drawn)]);
      if (!lack) {
        expect(hasFailed).toBe(false);
        cloud.destroy();
        return;
      }
      failures++;
      expect(lack.message).toMatch(/^more needs \d+ bytes more of the GPU's memory/);
      expect(lackOfFrame).toBe(lack);
      expect(cloud.isDestroyed).toBe(true);
      expect(engine.memory().totalBytes).toBe(totalBytes);
      expect(() => view.render(request)).toThrow(lack);
      expect(view.render(small)).toBe(false);
      expect(await view.readPixels()).toEqual(before);
    });
    expect(failures).toBe(3);
    engine.destroy();
  });

  /**
   * @fault GPU memory: a load finds no memory
   * @consequence `GpuLimitError`; the load leaves nothing
   */
  gpuTest('of a file whose rows the GPU packs: the load fails, and leaves nothing', async () => {
    const engine = await createEngine({ device: failing.device }, { ingestMinRows: 1 });
    const file = encodePly(MORE);
    (await engine.load(file)).destroy();
    const { totalBytes } = engine.memory();
    let failures = 0;
    await failEach(async (stop) => {
      const loading = engine.load(file);
      const lack = await lackOf(loading);
      expect(stop()).toBe(lack !== null);
      if (lack) failures++;
      else (await loading).destroy();
      expect(engine.memory().totalBytes).toBe(totalBytes);
    });
    expect(failures).toBeGreaterThan(20);
    engine.destroy();
  });

  /**
   * @fault GPU memory: a pick, or reading pixels, finds no memory
   * @consequence `GpuLimitError`; the next one works
   */
  gpuTest('of a pick or of pixels read back: they fail, and the next do not', async () => {
    const engine = await SplatEngine.create({ device: failing.device });
    const view = engine.createView();
    view.render({ camera: CAMERA, clouds: [{ cloud: engine.add(FEW) }], ...SIZE });
    const reads = [() => view.readPixels(), () => view.pick(16, 12)];
    for (const read of reads) {
      const expected = await read();
      const { totalBytes } = engine.memory();
      let failures = 0;
      await failEach(async (stop) => {
        const lack = await lackOf(read());
        expect(stop()).toBe(lack !== null);
        if (lack) failures++;
        expect(engine.memory().totalBytes).toBe(totalBytes);
        expect(await read()).toEqual(expected);
      });
      expect(failures).toBeGreaterThan(0);
    }
    engine.destroy();
  });

  /**
   * @fault GPU memory: an upload or a scan fails midway
   * @consequence all earlier allocations are freed
   */
  gpuTest('of planes, if it throws: those before are freed', () => {
    const { device } = failing;
    const packed = packSet(FEW, { geometryPrecision: 'packed', shPrecision: 'u8' });
    const complete = new ScarceMemory(device, Number.POSITIVE_INFINITY);
    CloudPlanes.upload(complete, device.limits, packed, 'few');
    expect(complete.buffersMade).toBeGreaterThan(2);
    for (let buffers = 0; buffers < complete.buffersMade; buffers++) {
      const memory = new ScarceMemory(device, buffers);
      expect(() => CloudPlanes.upload(memory, device.limits, packed, 'few')).toThrow('no more buffers');
      expect(memory.report().totalBytes).toBe(0);
    }
    complete.destroyAll();
  });
});

function greatestDifference({ data: a }: TextureImage, { data: b }: TextureImage): number {
  return a.reduce((most, value, i) => Math.max(most, Math.abs(value - b[i])), 0);
}

/**
 * @fault GPU memory: an image is larger than `maxBufferSize`
 * @consequence the image is read in strips; a row that is too large gives a `GpuLimitError`
 */
gpuTest('pixels above the largest buffer are read in strips', async () => {
  const whole = failing.device;
  // Rows of 32 pixels take 256 bytes.
  const limits = limitsWith(whole, { maxBufferSize: 256 * 7 });
  const engine = await SplatEngine.create({ device: whole });
  const view = engine.createView();
  view.render({ camera: CAMERA, clouds: [{ cloud: engine.add(FEW) }], ...SIZE });
  const expected = await view.readPixels();
  const { readTexture } = await import('./read-texture.ts');
  const { color } = view.blended();
  expect(await readTexture(deviceWith(whole, { limits }), color!)).toEqual(expected);
  const tooSmall = deviceWith(whole, { limits: limitsWith(whole, { maxBufferSize: 128 }) });
  await expect(readTexture(tooSmall, color!)).rejects.toThrow(GpuLimitError);
  engine.destroy();
});

/** A failing device that calls `onReclaim` when a frame's lost memory is being reclaimed. */
function reclaiming(onReclaim: () => void): GPUDevice {
  const { device } = failing;
  return deviceWith(device, {
    createCommandEncoder: (descriptor: GPUCommandEncoderDescriptor) => {
      if (descriptor.label === 'reclaim memory') onReclaim();
      return device.createCommandEncoder(descriptor);
    },
  });
}

describe('where tiles that were not asked for find no memory', () => {
  /**
   * @fault GPU memory: a newer request arrives before a lack of memory is known
   * @consequence the newer request is drawn, and the older frame does not follow it
   */
  gpuTest('a newer request is drawn, and not overtaken by their frame', async () => {
    let onReclaim = () => {};
    const engine = await SplatEngine.create({ device: reclaiming(() => onReclaim()) });
    const view = engine.createView();
    const request = { camera: CAMERA, clouds: [{ cloud: engine.add(FEW) }], ...SIZE };
    view.render(request);
    await view.whenDrawn();
    failing.failAfter(0);
    onReclaim = () => {
      onReclaim = () => {};
      expect(failing.stop()).toBe(true);
      view.render(request);
    };
    view.render({ ...request, ...LARGE_SIZE });
    await view.whenDrawn();
    expect(await view.readPixels()).toMatchObject(SIZE);
    engine.destroy();
  });

  gpuTest('and their cloud is held by then, the frame is drawn when it is not', async () => {
    let onReclaim = () => {};
    const free = signalOf();
    const engine = await SplatEngine.create({ device: reclaiming(() => onReclaim()) });
    const view = engine.createView();
    const cloud = engine.add(FEW);
    const request = { camera: CAMERA, clouds: [{ cloud }], ...SIZE };
    // Once its shaders are there.
    const first = engine.createView();
    first.render(request);
    await first.whenDrawn();
    onReclaim = () => {
      expect(failing.stop()).toBe(true);
      cloud.holdImage(free.when);
    };
    failing.failAfter(0);
    view.render(request);
    await expect.poll(() => cloud.isHeld).toBe(true);
    free.give();
    await view.whenDrawn();
    expect((await view.readPixels()).data.some((value) => value > 0)).toBe(true);
    engine.destroy();
  });
});

describe('a budget', () => {
  /**
   * @fault GPU memory: a frame is too large for the budget
   * @consequence smaller frames are drawn at once, even if their shaders come later
   */
  gpuTest('that one frame exceeds keeps no smaller one waiting, whose shaders come later', async () => {
    const accuracy = { rasterizer: 'quads' } as const;
    const engine = await SplatEngine.create({ device: failing.device, accuracy, memoryBudgetBytes: 400_000 });
    const view = engine.createView();
    const small = { camera: CAMERA, clouds: [{ cloud: engine.add(FEW) }], ...SIZE };
    view.render(small);
    await view.whenDrawn();
    expect(() => view.render({ ...small, widthPx: 1000, heightPx: 1000 })).toThrow(GpuLimitError);
    expect(view.render({ ...small, accuracy: { ...accuracy, extent: 'fixed' } })).toBe(true);
    await view.whenDrawn();
    expect(view.shape?.accuracy.extent).toBe('fixed');
    engine.destroy();
  });

  gpuTest('without room for the effects of a frame: the one before stays', async () => {
    const large = { camera: CAMERA, widthPx: 200, heightPx: 200 };
    const drawWith = async (memoryBudgetBytes?: number) => {
      const accuracy = { rasterizer: 'quads' } as const;
      const engine = await SplatEngine.create({ device: failing.device, accuracy, memoryBudgetBytes });
      const cloud = engine.add(FEW);
      const small = { camera: CAMERA, clouds: [{ cloud }], ...SIZE };
      const view = engine.createView();
      view.render(small);
      const before = await view.readPixels();
      view.render({
        ...large,
        clouds: [{ cloud, effects: [volumes([{ shape: 'plane', mode: 'keep', normal: [0, 0, 1] }])] }],
      });
      return { engine, view, small, before, drawn: view.whenDrawn() };
    };
    const whole = await drawWith();
    await whole.drawn;
    const { totalBytes } = whole.engine.memory();
    whole.engine.destroy();
    const { engine, view, small, before, drawn } = await drawWith(totalBytes - 1);
    await expect(drawn).rejects.toThrow(/^frame effects needs/);
    expect(view.render(small)).toBe(false);
    expect(await view.readPixels()).toEqual(before);
    engine.destroy();
  });

  /**
   * @fault GPU memory: the image over a host exceeds the budget
   * @consequence `draw` throws a `GpuLimitError` and records nothing; smaller ones are drawn
   */
  gpuTest(
    'without room for the image over a host: nothing is recorded, and a smaller one is drawn',
    async () => {
      const { device } = failing;
      const camera = CAMERA;
      const color = device.createTexture({
        size: [200, 200],
        format: 'rgba16float',
        usage: GPUTextureUsage.COPY_SRC | GPUTextureUsage.RENDER_ATTACHMENT,
      });
      const start = async (memoryBudgetBytes?: number) => {
        const accuracy = { rasterizer: 'quads' } as const;
        const engine = await SplatEngine.create({ device, accuracy, memoryBudgetBytes });
        const view = engine.createEmbeddedView();
        const small = { camera, clouds: [{ cloud: engine.add(FEW) }], ...SIZE };
        const draw = async (request: typeof small) => {
          for (;;) {
            const ready = new Promise<void>((resolve) => {
              view.onReady = resolve;
            });
            if (view.prepare(request)) break;
            await ready;
          }
          const encoder = device.createCommandEncoder();
          try {
            return view.draw(encoder, { color, depth: null, xPx: 0, yPx: 0 });
          } finally {
            device.queue.submit([encoder.finish()]);
            await device.queue.onSubmittedWorkDone();
          }
        };
        await draw(small);
        return { engine, small, large: { ...small, widthPx: 200, heightPx: 200 }, draw };
      };
      const whole = await start();
      await whole.draw(whole.large);
      const { totalBytes } = whole.engine.memory();
      whole.engine.destroy();
      const bytesPerPixel = 8;
      // For neither the image, nor the copy of the pixels behind it.
      for (const lackingBytes of [1, 1 + 200 * 200 * bytesPerPixel]) {
        const { engine, small, large, draw } = await start(totalBytes - lackingBytes);
        await expect(draw(large)).rejects.toThrow(GpuLimitError);
        const { color } = await draw(small);
        expect([color.width, color.height]).toEqual([SIZE.widthPx, SIZE.heightPx]);
        engine.destroy();
      }
      color.destroy();
    },
  );

  /**
   * @fault GPU memory: `memoryBudgetBytes` would be exceeded
   * @consequence `GpuLimitError` before anything is allocated
   */
  gpuTest('refuses clouds and frames above it; the earlier ones stay', async () => {
    const accuracy = { rasterizer: 'quads' } as const;
    const engine = await SplatEngine.create({ device: failing.device, accuracy, memoryBudgetBytes: 300_000 });
    const small = { camera: CAMERA, clouds: [{ cloud: engine.add(FEW) }], ...SIZE };
    const view = engine.createView();
    view.render(small);
    const before = await view.readPixels();
    const { totalBytes } = engine.memory();
    const many = randomSplats({ count: 20_000, shDegree: 0 });
    expect(() => engine.add(many)).toThrow(
      expect.objectContaining({ limit: 'memoryBudgetBytes', neededBytes: 640_000 }),
    );
    expect(() => view.render({ ...small, widthPx: 400, heightPx: 300 })).toThrow(GpuLimitError);
    expect(engine.memory().totalBytes).toBe(totalBytes);
    expect(view.render(small)).toBe(false);
    expect(await view.readPixels()).toEqual(before);
    engine.destroy();
    expect(() => engine.add(FEW)).toThrow(DestroyedError);
  });

  const set = randomSplats({ count: 4000, shDegree: 3 });
  for (const ingestMinRows of [1, Number.POSITIVE_INFINITY]) {
    const packer = ingestMinRows === 1 ? 'GPU' : 'CPU';
    /**
     * @fault GPU memory: a file is too large for its settings
     * @consequence the error holds options that fit; `fit: 'auto'` takes them, and `cloud.fit` says so
     */
    gpuTest(
      `that a load exceeds, packed on the ${packer}: it says what would fit, and takes it`,
      async () => {
        // With degree 3 in bytes the cloud takes 320 kB, and 1.9 MB more while it is packed.
        const memoryBudgetBytes = ingestMinRows === 1 ? 2_150_000 : 200_000;
        const engine = await createEngine(
          { device: failing.device, accuracy: { shPrecision: 'f32' }, memoryBudgetBytes },
          { ingestMinRows },
        );
        const file = encodePly(set);
        const error = await engine.load(file, { name: 'garden' }).catch((reason) => reason);
        expect(error).toBeInstanceOf(GpuLimitError);
        expect(error).toMatchObject({
          limit: 'memoryBudgetBytes',
          fitting: { precision: { shPrecision: 'u8' } },
        });
        expect(error.message).toMatch(/^garden needs \d+ bytes .* load it with fit: 'auto'\.$/);
        expect(engine.memory().totalBytes).toBe(0);

        const fitting = await engine.load(file, error.fitting);
        expect(fitting.precisions.sh).toEqual(['u8']);
        fitting.destroy();
        const cloud = await engine.load(file, { name: 'garden', fit: 'auto' });
        expect(cloud.fit).toMatchObject({
          wanted: { shPrecision: 'f32', shDegree: 3 },
          taken: error.fitting.precision,
        });
        expect(cloud.precisions.sh).toEqual(['u8']);
        expect(cloud.fit?.why).toContain('garden');
        expect(cloud.bytes).toBeLessThan(memoryBudgetBytes);
        const view = engine.createView();
        cloud.destroy();
        view.destroy();
        const small = await engine.load(encodePly(FEW), { fit: 'auto' });
        expect(small.fit).toBeNull();
        await expect(engine.load(file, { fit: 'auto', name: 'again' })).resolves.toBeDefined();
        engine.destroy();
      },
    );
  }
});
