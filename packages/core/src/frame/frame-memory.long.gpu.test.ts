// Proves: frames never hold old and new memory together, and start over after a lack.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterEach, beforeAll, describe, expect, vi } from 'vitest';
import { SplatCloud } from '../clouds/splat-cloud.ts';
import { SplatEngine } from '../create-engine.ts';
import { type Camera, perspectiveCamera } from '../data/camera/camera.ts';
import { GpuLimitError, InvalidArgumentError } from '../data/errors.ts';
import { drawMeasured } from '../measure/measured-frames.ts';
import { deviceWith } from '../testing/device-with.ts';
import { randomSplats } from '../testing/random-splats.ts';
import type { SplatView } from '../views/splat-view.ts';
import type { FrameRequest } from './plan/frame-request.ts';
import { ROOM_PERIOD_MS } from './plan/recent-peak.ts';

const SIZE = { widthPx: 32, heightPx: 32 };
/**
 * More splats than there is always room for; small ones, so that most chunks are clearly in or out.
 * All but one in 26 are too faint to be drawn, for which there is room all the same: drawn on the
 * CPU, frames of all would take seconds.
 */
const MANY = randomSplats({ count: 270_000, shDegree: 0, logScales: [-9, -7], opacityLogits: [-400, 10] });
const OVERVIEW = cameraAt([0, 0, 5]);
/** Looks out of the cloud, at a small part of it. */
const DETAIL = cameraAt([0, 0, -0.8]);

function cameraAt(position: [number, number, number]): Camera {
  return perspectiveCamera({ position, target: [0, 0, -1], fovYDegrees: 50, aspect: 1 });
}

/** The buffer that finds no memory, if any, and how the device reports that. */
let lacking: { readonly label: string; readonly how: 'throws' | 'reports' } | null = null;
let device: GPUDevice;
beforeAll(async () => {
  device = thatMayLackMemory(await shareTestDevice());
});
afterEach(() => {
  lacking = null;
  vi.restoreAllMocks();
});

function thatMayLackMemory(whole: GPUDevice): GPUDevice {
  let isLacking = false;
  const createBuffer = (descriptor: GPUBufferDescriptor) => {
    if (lacking && lacking.label === descriptor.label) {
      if (lacking.how === 'throws') throw new RangeError('createBuffer failed');
      isLacking = true;
    }
    return whole.createBuffer(descriptor);
  };
  const popErrorScope = async () => {
    const wasLacking = isLacking;
    isLacking = false;
    const error = await whole.popErrorScope();
    return wasLacking ? ({ message: 'out of memory' } as GPUOutOfMemoryError) : error;
  };
  return deviceWith(whole, { createBuffer, popErrorScope });
}

async function draw(view: SplatView, request: FrameRequest): Promise<Float32Array> {
  view.render(request);
  return (await view.readPixels()).data;
}

describe('room for visible splats', () => {
  gpuTest('grows without holding old and new, and shrinks some seconds after it was needed', async () => {
    const engine = await SplatEngine.create({
      device,
      accuracy: { preset: 'fast', rasterizer: 'quads' },
      // By the clock that is set forward below, frames would take seconds.
      submissionBudgetMs: Number.POSITIVE_INFINITY,
    });
    const clouds = [{ cloud: engine.add(MANY) }];
    const view = engine.createView();
    const detail = { camera: DETAIL, clouds, ...SIZE };
    const overview = { ...detail, camera: OVERVIEW };
    const detailImage = await draw(view, detail);
    const { totalBytes: detailBytes, scene, frames } = engine.memory();
    // Loaded splats add a few words per chunk; the layer and a ring of statistics come besides.
    const visibleBytes = 56 * (view.shape?.visibleCapacity ?? 0);
    expect(frames.totalBytes - visibleBytes).toBeLessThan(100_000);
    expect(frames.totalBytes).toBeLessThan(0.4 * scene.totalBytes);
    const overviewImage = await draw(view, overview);
    const { totalBytes: overviewBytes, peakBytes } = engine.memory();
    expect(overviewBytes).toBeGreaterThan(1.2 * detailBytes);
    expect(peakBytes).toBe(overviewBytes);

    const now = performance.now.bind(performance);
    let passedMs = 0;
    vi.spyOn(performance, 'now').mockImplementation(() => now() + passedMs);
    // A view at rest draws nothing, however long it rests.
    await draw(view, detail);
    passedMs += 10 * ROOM_PERIOD_MS;
    await draw(view, detail);
    expect(engine.memory().totalBytes).toBe(overviewBytes);
    // These are not looked at: drawn on the CPU, they would take ten seconds.
    const undrawn = vi.spyOn(device.queue, 'submit').mockReturnValue(undefined);
    for (let frame = 0; frame < 65; frame++) {
      passedMs += ROOM_PERIOD_MS / 25;
      view.render({ ...detail, force: true });
      await device.queue.onSubmittedWorkDone();
    }
    undrawn.mockRestore();
    expect(await draw(view, { ...detail, force: true })).toEqual(detailImage);
    expect(engine.memory()).toMatchObject({ totalBytes: detailBytes, peakBytes });
    expect(await draw(view, overview)).toEqual(overviewImage);
    expect(engine.memory()).toMatchObject({ totalBytes: overviewBytes, peakBytes });
    engine.destroy();
  });
});

describe('a frame that finds no memory', () => {
  for (const rasterizer of ['quads', 'tiles'] as const) {
    for (const label of ['frame records', 'frame visibleSplats', 'sort keys 1']) {
      for (const how of ['throws', 'reports'] as const) {
        /**
         * @fault GPU memory: even the last image finds no memory
         * @consequence `GpuLimitError`; the view is empty and starts over
         */
        gpuTest(`for ${label} of ${rasterizer}, if a device ${how} that: the next starts over`, async () => {
          const engine = await SplatEngine.create({ device, accuracy: { preset: 'balanced', rasterizer } });
          const few = engine.add(randomSplats({ count: 100 }));
          const many = engine.add(randomSplats({ count: 5000 }));
          const view = engine.createView();
          const request = { camera: OVERVIEW, clouds: [{ cloud: many }], ...SIZE };
          const expected = await draw(engine.createView(), request);
          const idleBytes = engine.memory().totalBytes;
          await draw(view, { ...request, clouds: [{ cloud: few }] });

          lacking = { label, how };
          if (how === 'reports') {
            view.render(request);
            // There is no memory for the picture before either.
            await expect(view.whenDrawn()).rejects.toThrow(GpuLimitError);
            expect(engine.memory().totalBytes).toBe(idleBytes);
          }
          // Told once, by the frame itself or by the next.
          expect(() => view.render(request)).toThrow(GpuLimitError);
          lacking = null;
          expect(engine.memory().totalBytes).toBe(idleBytes);
          await expect(view.readPixels()).rejects.toThrow(InvalidArgumentError);
          expect(view.effects()).toEqual([]);
          expect(await view.pick(16, 16)).toBeNull();
          expect(await draw(view, request)).toEqual(expected);
          engine.destroy();
        });
      }
    }
  }
});

gpuTest(
  'a cloud with a limit has room for that many visible splats, and draws the first of them',
  async () => {
    const engine = await SplatEngine.create({ device });
    const view = engine.createView();
    const set = randomSplats({ count: 3000, shDegree: 0 });
    const whole = engine.add(set);
    const precision = {
      geometryPrecision: whole.precisions.geometry[0],
      shPrecision: whole.precisions.sh[0],
    };
    const contents = { ...whole, chunks: whole.chunks, motion: null, precision };
    const seenWith = async (visibleLimit?: number) => {
      const options = { name: 'limited', isPreview: true, visibleLimit };
      const cloud = new SplatCloud(device, whole.planes, contents, options);
      const request = { ...SIZE, camera: OVERVIEW, clouds: [{ cloud }], force: true };
      const { visibleSplats: visible } = await drawMeasured(engine, view, request);
      return { pixels: (await view.readPixels()).data, visible, room: view.shape?.visibleCapacity };
    };
    const all = await seenWith();
    expect(all).toMatchObject({ visible: 3000, room: 3000 });
    expect(await seenWith(5000)).toEqual(all);

    const some = await seenWith(1000);
    expect(some).toMatchObject({ visible: 1000, room: 1000 });
    expect(some.pixels).not.toEqual(all.pixels);
    // Beside another cloud there is room for all of both.
    const { planes } = whole;
    const limited = new SplatCloud(device, planes, contents, { name: 'limited', visibleLimit: 9 });
    await draw(view, { ...SIZE, camera: OVERVIEW, clouds: [{ cloud: limited }, { cloud: whole }] });
    expect(view.shape?.visibleCapacity).toBe(6000);
    engine.destroy();
  },
);
