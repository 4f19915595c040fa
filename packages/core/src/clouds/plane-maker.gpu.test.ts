import { createTestDevice, gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { createEngine, SplatEngine } from '../create-engine.ts';
import { type Accuracy, resolveAccuracy } from '../data/accuracy/accuracy.ts';
import { DestroyedError, GpuLimitError, InvalidArgumentError, SplatSourceError } from '../data/errors.ts';
import { packSet } from '../data/packing/pack-set.ts';
import { type CloudPrecision, SH_PRECISIONS } from '../data/packing/precision.ts';
import { encodePly } from '../io/formats/ply/write-ply.ts';
import { compareImages, renderReference } from '../reference/index.ts';
import { deviceWith, limitsWith, type SomeLimits } from '../testing/device-with.ts';
import { NARROW_REFERENCE } from '../testing/narrow-reference.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { signalOf } from '../testing/signal.ts';
import { testCameras } from '../testing/test-cameras.ts';
import type { SplatCloud } from './splat-cloud.ts';

const SIZE = { widthPx: 64, heightPx: 64 };
const CAMERA = testCameras(1).perspective;
const set = randomSplats({ count: 600 });
const FINEST: CloudPrecision = { geometryPrecision: 'f32', shPrecision: 'f32' };
const SMALLEST: CloudPrecision = { geometryPrecision: 'packed', shPrecision: 'u8' };
const REFERENCE = renderReference({ clouds: [{ set }], camera: CAMERA, ...SIZE });

let device: GPUDevice;
let engine: SplatEngine;
beforeAll(async () => {
  device = await shareTestDevice();
  // One chunk of the largest plane per page.
  const bytes = 180 * 256;
  engine = await createEngine(
    {
      device: withLimits(device, { maxBufferSize: bytes, maxStorageBufferBindingSize: bytes }),
      accuracy: NARROW_REFERENCE,
    },
    { maxWorkgroupsPerDimension: 3 },
  );
});

async function imageOf(cloud: SplatCloud, accuracy: Accuracy = NARROW_REFERENCE): Promise<Float32Array> {
  const view = engine.createView();
  view.render({ camera: CAMERA, clouds: [{ cloud }], accuracy, ...SIZE });
  const { data } = await view.readPixels();
  view.destroy();
  return data;
}

const psnrDb = (actual: Float32Array, expected: ArrayLike<number>) =>
  compareImages(actual, expected as Float32Array, SIZE).psnrDb;

function expectHeld(cloud: SplatCloud, { geometryPrecision, shPrecision }: CloudPrecision): void {
  expect(cloud.precisions).toEqual({ geometry: [geometryPrecision], sh: [shPrecision] });
}

describe('a coarser precision', () => {
  for (const [geometryPrecision, shPrecision] of [
    ['f32', 'f16'],
    ['f32', 'u8'],
    ['packed', 'f32'],
    ['packed', 'u8'],
  ] as const) {
    gpuTest(`${geometryPrecision} geometry, ${shPrecision} harmonics: as if loaded with it`, async () => {
      const wanted = { geometryPrecision, shPrecision };
      const before = engine.memory().totalBytes;
      const cloud = engine.add(set);
      await engine.requestPrecision(cloud, wanted);
      expectHeld(cloud, wanted);
      const made = await imageOf(cloud);
      const { bytes } = cloud;
      const held = engine.memory().totalBytes;
      cloud.destroy();
      expect(cloud.bytes).toBe(0);
      expect(engine.memory().totalBytes).toBe(before);

      const loaded = engine.addPacked(packSet(set, wanted));
      expect(loaded.bytes).toBe(bytes);
      expect(engine.memory().totalBytes).toBe(held);
      const expected = await imageOf(loaded);
      // Halves are equal to the bit; steps may differ by one if both are equally near in float32.
      if (geometryPrecision === 'f32' && shPrecision === 'f16') expectSameImage(made, expected);
      else expect(psnrDb(made, expected)).toBeGreaterThan(80);
      loaded.destroy();
    });
  }

  gpuTest('is made from the planes held if they are not the finest', async () => {
    const cloud = engine.addPacked(packSet(set, { geometryPrecision: 'packed', shPrecision: 'f16' }));
    await cloud.hold(SMALLEST).met;
    expect(cloud.precisions).toEqual({ geometry: ['packed'], sh: ['f16', 'u8'] });
    await engine.requestPrecision(cloud, SMALLEST);
    expectHeld(cloud, SMALLEST);
    cloud.destroy();
  });

  gpuTest('needs no harmonics at degree 0', async () => {
    const cloud = engine.addPacked(packSet(randomSplats({ count: 300, shDegree: 0 }), FINEST));
    await engine.requestPrecision(cloud, SMALLEST);
    await engine.requestPrecision(cloud, { geometryPrecision: 'packed', shPrecision: 'f32' });
    expect(cloud.precisions).toEqual({ geometry: ['packed'], sh: SH_PRECISIONS });
    cloud.destroy();
  });

  gpuTest('changes the next frame; a frame whose planes stay is not drawn again', async () => {
    const cloud = engine.add(set);
    const view = engine.createView();
    const frame = { camera: CAMERA, clouds: [{ cloud }], ...SIZE };
    view.render(frame);
    const fine = (await view.readPixels()).data;
    await cloud.hold(SMALLEST).met;
    expect(view.render(frame)).toBe(false);
    await engine.requestPrecision(cloud, SMALLEST);
    expect(view.render(frame)).toBe(true);
    const coarse = (await view.readPixels()).data;
    expect(psnrDb(coarse, fine)).toBeLessThan(80);
    view.destroy();
    cloud.destroy();
  });
});

describe('a finer precision', () => {
  const file = new Blob([encodePly(set)]);

  gpuTest('reads the source again while the view keeps its image; and back', async () => {
    const small = { ...resolveAccuracy('reference'), ...SMALLEST };
    const { device: limited } = engine;
    const other = await SplatEngine.create({ device: limited, accuracy: small });
    const cloud = await other.load(file, { name: 'garden' });
    expectHeld(cloud, SMALLEST);
    const { bytes } = cloud;
    const { totalBytes } = other.memory();
    const view = other.createView();
    const frame = { camera: CAMERA, clouds: [{ cloud }], accuracy: NARROW_REFERENCE, ...SIZE } as const;
    view.render(frame);
    const coarse = (await view.readPixels()).data;

    const phases = new Set<string>();
    const finer = other.requestPrecision(cloud, FINEST, { onProgress: ({ phase }) => phases.add(phase) });
    expect(view.render({ ...frame, force: true })).toBe(true);
    expectSameImage((await view.readPixels()).data, coarse);
    await finer;
    expect(phases).toContain('read');
    expectHeld(cloud, FINEST);
    expect(other.counters().uploadedBytes).toBe(bytes + 600 * (64 + 180));
    expect(view.render(frame)).toBe(true);
    const fine = (await view.readPixels()).data;
    const fineDb = psnrDb(fine, REFERENCE.data);
    expect(fineDb).toBeGreaterThanOrEqual(60);
    expect(psnrDb(coarse, REFERENCE.data)).toBeLessThan(fineDb);

    view.destroy();
    await other.requestPrecision(cloud, SMALLEST);
    expect(cloud.bytes).toBe(bytes);
    await expect.poll(() => other.memory().totalBytes).toBe(totalBytes);
    other.destroy();
  });

  gpuTest('reads only the missing precision', async () => {
    const cloud = engine.addPacked(packSet(set, { geometryPrecision: 'f32', shPrecision: 'u8' }), {
      source: file,
    });
    const before = engine.counters().uploadedBytes;
    await engine.requestPrecision(cloud, { geometryPrecision: 'packed', shPrecision: 'f32' });
    expect(engine.counters().uploadedBytes - before).toBe(600 * 180);
    expectHeld(cloud, { geometryPrecision: 'packed', shPrecision: 'f32' });
    cloud.destroy();
  });

  gpuTest('can also come from splats in memory', async () => {
    for (const source of [set, packSet(set, FINEST)]) {
      const cloud = engine.addPacked(packSet(set, SMALLEST), { source });
      // The packed source is finer than requested: the missing planes are made from it.
      await engine.requestPrecision(cloud, { geometryPrecision: 'f32', shPrecision: 'f16' });
      expectHeld(cloud, { geometryPrecision: 'f32', shPrecision: 'f16' });
      expect(psnrDb(await imageOf(cloud), REFERENCE.data)).toBeGreaterThan(50);
      cloud.destroy();
    }
  });

  gpuTest('comes from the first of several sources that is fine enough', async () => {
    const packed = packSet(set, { geometryPrecision: 'f32', shPrecision: 'u8' });
    let reads = 0;
    const counted = Object.assign(new Blob([encodePly(set)]), {
      stream: () => {
        reads++;
        return file.stream();
      },
    });
    const cloud = engine.addPacked(packSet(set, SMALLEST), { name: 'garden', source: [packed, counted] });
    await engine.requestPrecision(cloud, { geometryPrecision: 'f32', shPrecision: 'u8' });
    expect(reads).toBe(0);
    await engine.requestPrecision(cloud, FINEST);
    expect(reads).toBe(1);
    expectHeld(cloud, FINEST);
    cloud.destroy();

    const stale = new Blob([encodePly(randomSplats({ count: 599 }))]);
    const other = engine.addPacked(packSet(set, SMALLEST), { name: 'garden', source: [packed, stale] });
    await expect(engine.requestPrecision(other, FINEST)).rejects.toThrow(/garden.*599, then 600/);
    expectHeld(other, SMALLEST);
    other.destroy();
  });

  gpuTest('fails if the source is gone, too coarse or has changed; nothing changes', async () => {
    const changed = randomSplats({ count: 600, seed: 2 });
    for (const [source, why] of [
      [undefined, /garden.*gone.*URL/],
      [packSet(set, SMALLEST), /garden.*packed geometry, u8 harmonics.*f32 geometry/],
      [changed, /garden.*other splats/],
      [new Blob([encodePly(randomSplats({ count: 599 }))]), /garden.*599, then 600/],
    ] as const) {
      const cloud = engine.addPacked(packSet(set, SMALLEST), { name: 'garden', source });
      const { totalBytes } = engine.memory();
      const request = engine.requestPrecision(cloud, FINEST);
      await expect(request).rejects.toThrow(SplatSourceError);
      await expect(request).rejects.toThrow(why);
      expectHeld(cloud, SMALLEST);
      expect(engine.memory().totalBytes).toBe(totalBytes);
      cloud.destroy();
    }
    const small = await SplatEngine.create({ device: engine.device });
    const fromBuffer = await small.load(encodePly(set));
    await expect(small.requestPrecision(fromBuffer, FINEST)).rejects.toThrow(SplatSourceError);
    small.destroy();
  });

  gpuTest('comes from an address while that exists', async () => {
    const small = await SplatEngine.create({ device: engine.device });
    const address = URL.createObjectURL(file);
    const cloud = await small.load(address);
    await small.requestPrecision(cloud, { geometryPrecision: 'f32', shPrecision: 'u8' });
    URL.revokeObjectURL(address);
    await expect(small.requestPrecision(cloud, FINEST)).rejects.toThrow(SplatSourceError);
    expectHeld(cloud, { geometryPrecision: 'f32', shPrecision: 'u8' });
    small.destroy();
  });

  for (const how of ['throws', 'reports'] as const) {
    gpuTest(`fails if a device ${how} that memory is lacking; nothing changes`, async () => {
      const cloud = engine.add(set, { name: 'garden' });
      await engine.requestPrecision(cloud, SMALLEST);
      const { totalBytes } = engine.memory();
      lacksMemory = { label: 'garden spherical harmonics 1', how };
      const request = engine.requestPrecision(cloud, FINEST);
      await expect(request).rejects.toThrow(GpuLimitError);
      await expect(request).rejects.toThrow(/garden.*146400 bytes/);
      lacksMemory = null;
      expectHeld(cloud, SMALLEST);
      expect(engine.memory().totalBytes).toBe(totalBytes);
      cloud.destroy();
    });
  }
});

describe("the engine's accuracy", () => {
  gpuTest('is requested of all clouds; those that cannot get it are returned, unchanged', async () => {
    // Shaders that are compiled: a frame with the new planes is drawn at once.
    const compiling = engine.add(set);
    await imageOf(compiling);
    compiling.destroy();
    const other = await SplatEngine.create({ device: engine.device, accuracy: 'balanced' });
    const lasting = other.add(set);
    const gone = other.addPacked(packSet(set, SMALLEST));
    const passing = other.add(set);
    const view = other.createView();
    const frame = { camera: CAMERA, clouds: [{ cloud: lasting }], ...SIZE };
    const change = other.setAccuracy(NARROW_REFERENCE);
    passing.destroy();
    view.render(frame);
    const early = (await view.readPixels()).data;
    const problems = await change;
    expect(problems.map(({ cloud }) => cloud)).toEqual([gone]);
    expect(problems[0].error).toBeInstanceOf(SplatSourceError);
    expectHeld(lasting, FINEST);
    expectHeld(gone, SMALLEST);
    expect(view.render(frame)).toBe(true);
    const late = (await view.readPixels()).data;
    expect(psnrDb(late, REFERENCE.data)).toBeGreaterThanOrEqual(60);
    expect(psnrDb(early, REFERENCE.data)).toBeLessThan(psnrDb(late, REFERENCE.data));

    const superseded = other.setAccuracy('balanced');
    const last = other.setAccuracy({ preset: 'reference', shPrecision: 'f16' });
    expect(await superseded).toEqual([]);
    await last;
    expectHeld(lasting, { geometryPrecision: 'f32', shPrecision: 'f16' });
    other.destroy();
  });

  gpuTest('applies to a cloud that was loading when it changed', async () => {
    const other = await SplatEngine.create({ device: engine.device, accuracy: 'balanced' });
    const loading = other.load(new Blob([encodePly(set)]));
    await other.setAccuracy('reference');
    const cloud = await loading;
    await expect.poll(() => cloud.precisions).toEqual({ geometry: ['f32'], sh: ['f32'] });
    other.destroy();
  });
});

describe('a request', () => {
  const file = new Blob([encodePly(set)]);

  gpuTest('can be cancelled, and a later one replaces it', async () => {
    const cloud = engine.addPacked(packSet(set, SMALLEST), { source: file });
    const { totalBytes } = engine.memory();
    const reason = new Error('no longer wanted');
    await expect(engine.requestPrecision(cloud, FINEST, { signal: AbortSignal.abort(reason) })).rejects.toBe(
      reason,
    );
    const stop = new AbortController();
    const stopped = engine.requestPrecision(cloud, FINEST, { signal: stop.signal });
    stop.abort(reason);
    await expect(stopped).rejects.toBe(reason);
    expectHeld(cloud, SMALLEST);
    expect(engine.memory().totalBytes).toBe(totalBytes);

    const first = engine.requestPrecision(cloud, FINEST);
    const last = engine.requestPrecision(cloud, { geometryPrecision: 'f32', shPrecision: 'u8' });
    await expect(first).rejects.toMatchObject({ name: 'AbortError' });
    await last;
    expectHeld(cloud, { geometryPrecision: 'f32', shPrecision: 'u8' });
    cloud.destroy();
  });

  gpuTest('ends with its cloud, its engine or the device', async () => {
    const other = await createTestDevice();
    for (const end of ['cloud', 'engine', 'device'] as const) {
      const ending = await SplatEngine.create({ device: other });
      const cloud = ending.addPacked(packSet(set, SMALLEST), { source: file });
      const request = ending.requestPrecision(cloud, FINEST);
      ({ cloud, engine: ending, device: other })[end].destroy();
      await expect(request).rejects.toThrow(DestroyedError);
      await expect(ending.requestPrecision(cloud, FINEST)).rejects.toThrow(DestroyedError);
      if (end === 'cloud') expect(ending.memory().totalBytes).toBe(0);
      ending.destroy();
    }
  });

  gpuTest('rejects unknown precisions', async () => {
    const cloud = engine.add(set);
    const wrong = { geometryPrecision: 'f64', shPrecision: 'f32' } as unknown as CloudPrecision;
    await expect(engine.requestPrecision(cloud, wrong)).rejects.toThrow(InvalidArgumentError);
    cloud.destroy();
  });
});

describe('several holders', () => {
  /** A file whose reading waits for `open`, and how often it was requested. */
  function gatedFile() {
    const { when: opened, give: open } = signalOf();
    const bytes = encodePly(set);
    const state = { reads: 0 };
    const stream = () => {
      state.reads++;
      const pull = async (controller: ReadableStreamDefaultController<Uint8Array>) => {
        await opened;
        controller.enqueue(bytes.slice());
        controller.close();
      };
      return new ReadableStream({ pull });
    };
    return { source: Object.assign(new Blob([bytes]), { stream }), state, open };
  }

  gpuTest('read a source once for planes that both need; other claims do not wait', async () => {
    const { source, state, open } = gatedFile();
    const held = { geometryPrecision: 'packed', shPrecision: 'f16' } as const;
    const cloud = engine.addPacked(packSet(set, held), { source });
    const before = engine.memory().totalBytes;
    const [first, second] = [cloud.hold(FINEST), cloud.hold(FINEST)];
    await expect.poll(() => state.reads).toBe(1);
    const coarse = cloud.hold(SMALLEST);
    await coarse.met;
    expect(cloud.precisions).toEqual({ geometry: ['packed'], sh: ['f16', 'u8'] });
    open();
    await Promise.all([first.met, second.met]);
    expect(state.reads).toBe(1);
    expect(cloud.precisions).toEqual({ geometry: ['f32', 'packed'], sh: ['f32', 'f16', 'u8'] });
    first.release();
    coarse.release();
    expect(cloud.precisions).toEqual({ geometry: ['f32', 'packed'], sh: ['f32', 'f16'] });
    second.release();
    expectHeld(cloud, held);
    expect(engine.memory().totalBytes).toBe(before);
    cloud.destroy();
  });

  gpuTest('do not wait for a claim that is cancelled before its turn to read', async () => {
    const { source, state, open } = gatedFile();
    const cloud = engine.addPacked(packSet(set, SMALLEST), { source });
    const first = cloud.hold(FINEST);
    await expect.poll(() => state.reads).toBe(1);
    const [second, third] = [cloud.hold(FINEST), cloud.hold(FINEST)];
    second.release();
    await expect(second.met).rejects.toMatchObject({ name: 'AbortError' });
    first.release();
    await expect(first.met).rejects.toMatchObject({ name: 'AbortError' });
    open();
    await third.met;
    expect(state.reads).toBe(2);
    third.release();
    expectHeld(cloud, SMALLEST);
    cloud.destroy();
  });

  gpuTest('that make the same planes simultaneously leave one of each', async () => {
    const cloud = engine.add(set);
    const before = engine.memory().totalBytes;
    const leases = [cloud.hold(SMALLEST), cloud.hold(SMALLEST)];
    await Promise.all(leases.map(({ met }) => met));
    expect(cloud.precisions).toEqual({ geometry: ['f32', 'packed'], sh: ['f32', 'u8'] });
    cloud.ownLease.release();
    expectHeld(cloud, SMALLEST);
    await engine.requestPrecision(cloud, FINEST);
    for (const lease of leases) lease.release();
    expectHeld(cloud, FINEST);
    expect(engine.memory().totalBytes).toBe(before);
    cloud.destroy();
  });

  gpuTest('keep what they claim when the accuracy of the engine changes', async () => {
    const other = await SplatEngine.create({ device: engine.device, accuracy: 'reference' });
    const cloud = other.add(set);
    const lease = cloud.hold({ geometryPrecision: 'f32', shPrecision: 'f16' });
    await lease.met;
    await other.setAccuracy('balanced');
    expect(cloud.precisions).toEqual({ geometry: ['f32', 'packed'], sh: ['f16', 'u8'] });
    lease.release();
    expectHeld(cloud, SMALLEST);
    other.destroy();
  });
});

/** The buffer that does not fit into memory, if any, and how the device reports that. */
let lacksMemory: { readonly label: string; readonly how: 'throws' | 'reports' } | null = null;

/** `whole` with these limits, and out of memory for the buffer `lacksMemory`. */
function withLimits(whole: GPUDevice, limits: SomeLimits): GPUDevice {
  const createBuffer = (descriptor: GPUBufferDescriptor) => {
    if (lacksMemory?.how === 'throws' && lacksMemory.label === descriptor.label)
      throw new RangeError('createBuffer failed');
    return whole.createBuffer(descriptor);
  };
  const popErrorScope = async () => {
    const error = await whole.popErrorScope();
    return lacksMemory ? ({ message: 'out of memory' } as GPUOutOfMemoryError) : error;
  };
  return deviceWith(whole, { limits: limitsWith(whole, limits), createBuffer, popErrorScope });
}

/** Bit for bit. */
function expectSameImage(actual: Float32Array, expected: Float32Array): void {
  expect(Buffer.compare(Buffer.from(actual.buffer), Buffer.from(expected.buffer))).toBe(0);
}
