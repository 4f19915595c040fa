// Proves: planes read again from a file are those of a first load.
import { createTestDevice, gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, beforeEach, describe, expect } from 'vitest';
import { createEngine, type SplatEngine } from '../create-engine.ts';
import { DestroyedError, GpuLimitError, SplatFileError, SplatSourceError } from '../data/errors.ts';
import { GEOMETRY_WORDS } from '../data/packing/geometry.ts';
import { shWordsPerSplat } from '../data/packing/harmonics.ts';
import { packSet } from '../data/packing/pack-set.ts';
import type { RowPrecision } from '../data/packing/precision.ts';
import type { EngineSeams } from '../engine.ts';
import { encodePly } from '../io/formats/ply/write-ply.ts';
import { readSplats } from '../io/loading/read-splats.ts';
import { deviceWith } from '../testing/device-with.ts';
import { expectSameGeometry, expectSameHarmonics } from '../testing/expect-same-planes.ts';
import { ownHarmonics } from '../testing/own-harmonics.ts';
import { planeWords } from '../testing/plane-words.ts';
import { plyBytes, splatElement } from '../testing/ply-fixture.ts';
import { randomSplats, splatsWithTies } from '../testing/random-splats.ts';
import { readableDevice } from '../testing/readable-device.ts';
import { signalOf } from '../testing/signal.ts';
import { testCameras } from '../testing/test-cameras.ts';
import type { SplatCloud } from './splat-cloud.ts';

const SMALLEST: RowPrecision = { geometryPrecision: 'packed', shPrecision: 'u8' };
const FINEST: RowPrecision = { geometryPrecision: 'f32', shPrecision: 'f32' };
const SIZE = { widthPx: 32, heightPx: 32 };
/** Two chunks of the largest plane per page, and pieces of one chunk. */
const BINDING_BYTES = 180 * 512;
const accuracy = 'balanced';
const SEAMS: EngineSeams = { ingestMinRows: 1, maxWorkgroupsPerDimension: 2 };

let device: GPUDevice;
let engine: SplatEngine;
/** Labels of the buffers that the test has made. */
const labels: string[] = [];
/** Called with the label of each buffer before it is made. */
let onBuffer = (_label: string) => {};
/** Label of the first buffer for which memory is lacking, if any. */
let lackingFor: string | null = null;
beforeAll(async () => {
  device = await shareTestDevice();
  const limits = { maxStorageBufferBindingSize: BINDING_BYTES };
  const limited = readableDevice(device, limits, (label) => {
    labels.push(label);
    onBuffer(label);
  });
  engine = await createEngine({ device: withScarceMemory(limited), accuracy }, SEAMS);
});
beforeEach(() => {
  labels.length = 0;
  onBuffer = () => {};
  lackingFor = null;
});

/** `whole`, which reports that memory is lacking from the buffer `lackingFor` on. */
function withScarceMemory(whole: GPUDevice): GPUDevice {
  const popErrorScope = async () => {
    const isLacking = lackingFor !== null && labels.includes(lackingFor);
    const error = await whole.popErrorScope();
    return isLacking ? ({ message: 'out of memory' } as GPUOutOfMemoryError) : error;
  };
  return deviceWith(whole, { popErrorScope });
}

const plyOf = (...set: Parameters<typeof splatsWithTies>) => new Blob([encodePly(splatsWithTies(...set))]);

/** Whether the rows of a file went to the GPU. */
const haveRowsGone = () => labels.includes('ingest rows');

/** Files of one size, one after another: each is read in its turn, the last from then on. */
function changing(...files: readonly Blob[]) {
  let reads = 0;
  const stream = () => files[Math.min(reads++, files.length - 1)].stream();
  return Object.assign(new Blob([files[0]]), { stream });
}

/** A file that stops halfway from its second reading on, until `open`. */
function halting(file: Blob) {
  const { when: opened, give: open } = signalOf();
  const state = { reads: 0, hasHalted: false };
  const stream = () => {
    const isHalting = state.reads++ > 0;
    const half = file.size >> 1;
    const parts = [file.slice(0, half), file.slice(half)];
    const pull = async (controller: ReadableStreamDefaultController<Uint8Array>) => {
      if (isHalting && parts.length === 1) {
        state.hasHalted = true;
        await opened;
      }
      const part = parts.shift();
      if (part) controller.enqueue(new Uint8Array(await part.arrayBuffer()));
      else controller.close();
    };
    return new ReadableStream({ pull }, { highWaterMark: 0 });
  };
  return { source: Object.assign(new Blob([file]), { stream }), state, open };
}

/** The words of the planes of one precision. */
async function wordsOf(cloud: SplatCloud, { geometryPrecision, shPrecision }: RowPrecision) {
  const { planes, shDegree } = cloud;
  return {
    geometry: await planeWords(
      cloud,
      planes.geometryPlane(geometryPrecision)!,
      GEOMETRY_WORDS[geometryPrecision],
    ),
    harmonics: await planeWords(cloud, planes.shPlane(shPrecision)!, shWordsPerSplat(shDegree, shPrecision)),
  };
}

function expectHeld(cloud: SplatCloud, { geometryPrecision, shPrecision }: RowPrecision): void {
  expect(cloud.precisions.geometry).toEqual([geometryPrecision]);
  if (cloud.shDegree > 0) expect(cloud.precisions.sh).toEqual([shPrecision]);
}

/** Expects the planes that a first load of `file` in this precision makes, on GPU and on CPU. */
async function expectAsLoaded(cloud: SplatCloud, file: Blob, precision: RowPrecision): Promise<void> {
  const made = await wordsOf(cloud, precision);
  const loaded = await engine.load(file, { precision });
  expect(made).toEqual(await wordsOf(loaded, precision));
  loaded.destroy();
  const reference = packSet(await readSplats(file, { shPrecision: precision.shPrecision }), precision);
  expect(cloud.fileIndices).toEqual(reference.fileIndices);
  expectSameGeometry({ ...reference.geometry, words: made.geometry }, reference.geometry);
  const harmonics = ownHarmonics(reference.harmonics);
  expectSameHarmonics({ ...harmonics, words: made.harmonics }, harmonics, reference.count);
}

gpuTest('a file is read again in the format that it was first said to have', async () => {
  const row = new Uint8Array(32).fill(128);
  new Float32Array(row.buffer, 0, 6).set([1, 2, 3, 0.1, 0.1, 0.1]);
  const cloud = await engine.load(new Blob([row]), { precision: SMALLEST, format: 'splat' });
  await engine.requestPrecision(cloud, FINEST);
  expectHeld(cloud, FINEST);
  cloud.destroy();
});

describe('a file whose rows the GPU takes is read again', () => {
  for (const [geometryPrecision, shPrecision] of [
    ['packed', 'f16'],
    ['packed', 'f32'],
    ['f32', 'u8'],
    ['f32', 'f16'],
    ['f32', 'f32'],
  ] as const) {
    for (const shDegree of [0, 3] as const) {
      const wanted = { geometryPrecision, shPrecision };
      gpuTest(`for ${geometryPrecision} geometry, ${shPrecision} harmonics, degree ${shDegree}`, async () => {
        const file = plyOf(1300, shDegree, 97);
        const cloud = await engine.load(file);
        const { totalBytes } = engine.memory();
        const { uploadedBytes } = engine.counters();
        const { bytes } = cloud;
        labels.length = 0;
        await engine.requestPrecision(cloud, wanted);
        // Planes without harmonics are of every precision.
        expect(haveRowsGone()).toBe(geometryPrecision === 'f32' || shDegree > 0);
        expectHeld(cloud, wanted);
        expect(engine.memory().totalBytes, 'only the planes are left').toBe(totalBytes - bytes + cloud.bytes);
        const freshBytes =
          (geometryPrecision === 'f32' ? 4 * GEOMETRY_WORDS.f32 : 0) +
          (shPrecision === 'u8' ? 0 : 4 * shWordsPerSplat(shDegree, shPrecision));
        expect(engine.counters().uploadedBytes - uploadedBytes).toBe(cloud.count * freshBytes);
        await expectAsLoaded(cloud, file, wanted);
        cloud.destroy();
      });
    }
  }

  gpuTest('for planes in the pages of a cloud that the CPU made', async () => {
    const set = splatsWithTies(1300, 3, 97);
    // Bands that cannot be seen are not stored, so that more splats fit a page.
    set.harmonics.coefficients.fill(0);
    const file = new Blob([encodePly(set)]);
    const cloud = engine.addPacked(packSet(set, SMALLEST), { source: file });
    expect(cloud.shDegree).toBe(0);
    await engine.requestPrecision(cloud, FINEST);
    expect(haveRowsGone()).toBe(true);
    expectHeld(cloud, FINEST);
    const loaded = await engine.load(file, { precision: FINEST });
    expect(loaded.planes.ranges).not.toEqual(cloud.planes.ranges);
    loaded.destroy();
    await expectAsLoaded(cloud, file, FINEST);
    cloud.destroy();
  });

  gpuTest('while views keep their image', async () => {
    const { source, state, open } = halting(plyOf(1300, 3));
    const cloud = await engine.load(source);
    const view = engine.createView();
    const frame = { camera: testCameras(1).perspective, clouds: [{ cloud }], accuracy: 'reference', ...SIZE };
    view.render({ ...frame, accuracy: 'reference' });
    const coarse = (await view.readPixels()).data;
    const request = engine.requestPrecision(cloud, FINEST);
    await expect.poll(() => state.hasHalted).toBe(true);
    view.render({ ...frame, accuracy: 'reference', force: true });
    expect((await view.readPixels()).data).toEqual(coarse);
    open();
    await request;
    expect(view.render({ ...frame, accuracy: 'reference' })).toBe(true);
    expect((await view.readPixels()).data).not.toEqual(coarse);
    view.destroy();
    cloud.destroy();
  });
});

gpuTest('a file of another kind is read again on the CPU', async () => {
  const values = randomSplats({ count: 300, shDegree: 1 });
  const element = splatElement(300, 1, (name, row) =>
    name === 'x' ? values.positions[row] : ((row * 7 + name.length) % 11) / 8,
  );
  for (const format of ['ascii', 'binary_little_endian'] as const) {
    const properties = element.properties.map((property) => ({ ...property, type: 'double' }));
    const file = new Blob([plyBytes({ format, elements: [{ ...element, properties }] })]);
    const cloud = await engine.load(file);
    await engine.requestPrecision(cloud, FINEST);
    expectHeld(cloud, FINEST);
    expect(haveRowsGone()).toBe(false);
    await expectAsLoaded(cloud, file, FINEST);
    cloud.destroy();
  }
});

describe('nothing changes', () => {
  const file = plyOf(1300, 1);

  for (const [what, second, expected] of [
    [
      'other splats',
      new Blob([encodePly(randomSplats({ count: 1300, shDegree: 1, seed: 9 }))]),
      /garden.*other splats/,
    ],
    ['fewer splats', plyOf(1300, 1, 2), /garden.*650, then 1300/],
  ] as const) {
    gpuTest(`if the file has ${what} by then`, async () => {
      const cloud = await engine.load(changing(file, second), { name: 'garden' });
      const { totalBytes } = engine.memory();
      const before = await wordsOf(cloud, SMALLEST);
      const request = engine.requestPrecision(cloud, FINEST);
      await expect(request).rejects.toThrow(SplatSourceError);
      await expect(request).rejects.toThrow(expected);
      expectHeld(cloud, SMALLEST);
      expect(engine.memory().totalBytes).toBe(totalBytes);
      expect(await wordsOf(cloud, SMALLEST)).toEqual(before);
      cloud.destroy();
    });
  }

  gpuTest('if the file is cut off by then', async () => {
    const cloud = await engine.load(changing(file, file.slice(0, file.size >> 1)));
    const { totalBytes } = engine.memory();
    await expect(engine.requestPrecision(cloud, FINEST)).rejects.toThrow(SplatFileError);
    expectHeld(cloud, SMALLEST);
    expect(engine.memory().totalBytes).toBe(totalBytes);
    cloud.destroy();
  });

  for (const label of ['ingest rows', 'garden geometry 0', 'garden file rows', 'garden chunks 0']) {
    gpuTest(`if memory is lacking for ${label}`, async () => {
      const cloud = await engine.load(file, { name: 'garden' });
      const { totalBytes } = engine.memory();
      labels.length = 0;
      lackingFor = label;
      const request = engine.requestPrecision(cloud, FINEST);
      await expect(request).rejects.toThrow(GpuLimitError);
      await expect(request).rejects.toThrow(/garden does not fit.*f32 geometry.*it is unchanged/);
      expectHeld(cloud, SMALLEST);
      expect(engine.memory().totalBytes).toBe(totalBytes);
      cloud.destroy();
    });
  }

  gpuTest('if it is called off while splats are put into storage order', async () => {
    const cloud = await engine.load(file, { name: 'garden' });
    const { totalBytes } = engine.memory();
    const reason = new Error('no longer wanted');
    const stop = new AbortController();
    onBuffer = (label) => {
      if (label === 'garden file rows') stop.abort(reason);
    };
    const request = engine.requestPrecision(cloud, FINEST, { signal: stop.signal });
    await expect(request).rejects.toBe(reason);
    expectHeld(cloud, SMALLEST);
    expect(engine.memory().totalBytes).toBe(totalBytes);
    cloud.destroy();
  });

  gpuTest('if it is called off while rows arrive', async () => {
    const { source, state, open } = halting(file);
    const cloud = await engine.load(source);
    const { totalBytes } = engine.memory();
    const reason = new Error('no longer wanted');
    const stop = new AbortController();
    const request = engine.requestPrecision(cloud, FINEST, { signal: stop.signal });
    await expect.poll(() => state.hasHalted && haveRowsGone()).toBe(true);
    stop.abort(reason);
    await expect(request).rejects.toBe(reason);
    open();
    expectHeld(cloud, SMALLEST);
    expect(engine.memory().totalBytes).toBe(totalBytes);
    await engine.requestPrecision(cloud, FINEST);
    await expectAsLoaded(cloud, file, FINEST);
    cloud.destroy();
  });
});

describe('a request in the middle', () => {
  for (const end of ['cloud', 'engine', 'device'] as const) {
    gpuTest(`ends with its ${end}`, async () => {
      const other = await (end === 'device' ? createTestDevice() : shareTestDevice());
      const ending = await createEngine({ device: other, accuracy }, SEAMS);
      const { source, state, open } = halting(plyOf(1300, 1));
      const cloud = await ending.load(source);
      const request = ending.requestPrecision(cloud, FINEST);
      await expect.poll(() => state.hasHalted).toBe(true);
      ({ cloud, engine: ending, device: other })[end].destroy();
      open();
      await expect(request).rejects.toThrow(DestroyedError);
      if (end !== 'device') expect(ending.memory().totalBytes).toBe(0);
      ending.destroy();
      other.destroy();
    });
  }
});
