// Proves: times of frames and passes, with timestamps and without.
import { createNodeGpu } from '@websplatter/node';
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect, vi } from 'vitest';
import { SplatEngine } from '../create-engine.ts';
import { GpuLimitError, InvalidArgumentError } from '../data/errors.ts';
import { CHUNK_SPLATS } from '../data/layout/constants.ts';
import { frameStages } from '../frame/frame-passes.ts';
import { failingDevice } from '../testing/failing-device.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { testCameras } from '../testing/test-cameras.ts';
import type { SplatView } from '../views/splat-view.ts';
import { measureCopyBandwidth } from './copy-bandwidth.ts';
import { measureFrames } from './measure-frames.ts';
import { orbitCameras } from './orbit-cameras.ts';

const SET = randomSplats({ count: 900, seed: 31, shDegree: 2 });
const SIZE = { widthPx: 48, heightPx: 32 };
const COPY_BYTES = 2 ** 20;
const FRAMES = 3;

let device: GPUDevice;
let engine: SplatEngine;
beforeAll(async () => {
  const { adapter } = await createNodeGpu();
  const offered = (['timestamp-query'] as const).filter((feature) => adapter.features.has(feature));
  device = await shareTestDevice({ requiredFeatures: offered });
  engine = await SplatEngine.create({ device });
});

function optionsFor(of: SplatEngine) {
  const cloud = of.add(SET);
  const camera = testCameras(SIZE.widthPx / SIZE.heightPx).perspective;
  const cameras = orbitCameras(camera, cloud.robustBounds, { count: FRAMES, sweepDegrees: 3 });
  return { clouds: [{ cloud }], cameras, ...SIZE, copyBytes: COPY_BYTES };
}

describe('measureFrames', () => {
  gpuTest.for(['tiles', 'quads'] as const)(
    'times frames of %s and their passes',
    async (rasterizer, { skip }) => {
      if (!device.features.has('timestamp-query')) skip('this adapter has no timestamp-query');
      const options = optionsFor(engine);
      const heldBytes = engine.memory().totalBytes;
      const createView = vi.spyOn(engine, 'createView');
      const steps: string[] = [];
      const measured = await measureFrames(engine, {
        ...options,
        accuracy: { rasterizer },
        onProgress: ({ done, total, label }) => steps.push(`${done}/${total} ${label}`),
      });
      const view: SplatView = createView.mock.results[0].value;
      createView.mockRestore();
      expect(engine.memory().totalBytes).toBe(heldBytes);
      expect([steps[0], steps.at(-1)]).toEqual(['0/12 Warming up', '11/12 Timing passes']);

      expect(measured).toMatchObject({
        ...SIZE,
        frames: FRAMES,
        loadedSplats: 900,
        timing: 'gpu-timestamps',
      });
      expect(measured.rasterizer).toEqual({ rasterizer, reason: `${rasterizer} were asked for` });
      const { visibleSplats, candidateSplats, tilePairs, gpuMs, wallClockMs, stageMs } = measured;
      expect(visibleSplats.least).toBeGreaterThan(0);
      expect(visibleSplats.most).toBeLessThanOrEqual(candidateSplats.most);
      expect(tilePairs !== null).toBe(rasterizer === 'tiles');
      expect(gpuMs!.median).toBeGreaterThan(0);
      expect(gpuMs!.standardDeviation).toBeGreaterThanOrEqual(0);
      expect(wallClockMs.median).toBeGreaterThan(0);
      const sum = stageMs!.preprocess.low + stageMs!.sort.low + stageMs!.rasterize.low;
      expect(sum).toBeLessThanOrEqual(gpuMs!.p99);
      expect(measured.memory.totalBytes).toBeGreaterThan(heldBytes);
      expect(measured.copyBytesPerSecond).toBeGreaterThan(0);

      const { passes } = measured;
      const stages = frameStages(view.shape!).map((each) => ('stage' in each ? each : each[0]).stage);
      expect(new Set(passes!.map(({ stage }) => stage))).toEqual(new Set(stages));
      for (const { part, stage, bytes, dispatches, timeMs, bytesPerSecond } of passes!) {
        expect(bytes, `${part}: ${stage} has no rule in least-bytes.ts`).not.toBeNull();
        expect(dispatches).toBeGreaterThan(0);
        expect(timeMs.p99).toBeGreaterThanOrEqual(timeMs.median);
        const moved = bytes!.read + bytes!.written;
        const isKnown = moved > 0 && timeMs.median > 0;
        if (isKnown) expect(bytesPerSecond).toBeCloseTo(moved / (timeMs.median / 1000), -3);
        else expect(bytesPerSecond).toBeNull();
      }
      const project = passes!.find(({ stage }) => stage === 'project')!;
      // By splat: its number, 32 bytes of geometry, 2 + 24 of harmonics in 7 words; a 32-byte
      // record and a key. By chunk: 8 bytes.
      const chunkBytes = 8 * Math.ceil(900 / CHUNK_SPLATS);
      expect(project.bytes!.read).toBe(visibleSplats.median * (4 + 32 + 28) + chunkBytes);
      expect(project.bytes!.written).toBe(visibleSplats.median * (32 + 4));
      const last = passes!.findLast(({ stage }) => stage.endsWith('rasterize'))!;
      expect(last.part).toBe('rasterize');
      const drawing = rasterizer === 'tiles' ? passes!.find(({ part }) => part === 'tiles')! : last;
      // rgba16float.
      expect(drawing.bytes!.written).toBe(8 * SIZE.widthPx * SIZE.heightPx);
      if (rasterizer === 'tiles') expect(last.bytes).toEqual({ read: 0, written: 0 });
      options.clouds[0].cloud.destroy();
    },
  );

  gpuTest('without timestamps it knows the wall clock only', async () => {
    const plain = await shareTestDevice();
    const plainEngine = await SplatEngine.create({ device: plain });
    const measured = await measureFrames(plainEngine, {
      ...optionsFor(plainEngine),
      accuracy: { rasterizer: 'tiles' },
    });
    expect(measured).toMatchObject({ timing: 'wall-clock', gpuMs: null, stageMs: null, passes: null });
    expect(measured.wallClockMs.median).toBeGreaterThan(0);
    plainEngine.destroy();
    plain.destroy();
  });

  gpuTest('ends when its signal is aborted, and refuses what it cannot draw', async () => {
    const options = optionsFor(engine);
    const heldBytes = engine.memory().totalBytes;
    const ended = new AbortController();
    const running = measureFrames(engine, {
      ...options,
      signal: ended.signal,
      onProgress: ({ label }) => {
        if (label !== 'Warming up') ended.abort(new Error('enough'));
      },
    });
    await expect(running).rejects.toThrow('enough');
    expect(engine.memory().totalBytes).toBe(heldBytes);
    for (const wrong of [{ cameras: [] }, { clouds: [] }, { widthPx: 0 }, { heightPx: 1.5 }])
      await expect(measureFrames(engine, { ...options, ...wrong })).rejects.toThrow(InvalidArgumentError);
    options.clouds[0].cloud.destroy();
  });
});

gpuTest('the bandwidth of copies is a rate, and leaves nothing on the device', async () => {
  const failing = failingDevice(device);
  failing.failAfter(1);
  await expect(measureCopyBandwidth(failing.device, { bytes: COPY_BYTES })).rejects.toThrow(GpuLimitError);
  const few = await measureCopyBandwidth(device, { bytes: COPY_BYTES, samples: 3 });
  expect(few).toBeGreaterThan(1e6);
  expect(few).toBeLessThan(1e15);
});
