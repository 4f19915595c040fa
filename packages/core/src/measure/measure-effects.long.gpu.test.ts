// Proves: effects are timed by frames in the same buffers.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect, vi } from 'vitest';
import { SplatEngine } from '../create-engine.ts';
import { InvalidArgumentError } from '../data/errors.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import { tint } from '../gpu/effects/index.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { testCameras } from '../testing/test-cameras.ts';
import { measureEffects } from './measure-effects.ts';

const SET = randomSplats({ count: 500, seed: 90, shDegree: 1, logScales: [-5, -4] });
const CAMERA = testCameras(1).perspective;

let device: GPUDevice;
let engine: SplatEngine;
let frame: FrameRequest;
beforeAll(async () => {
  device = await shareTestDevice();
  engine = await SplatEngine.create({ device });
  const clouds = [{ cloud: engine.add(SET), effects: [tint([1, 0.5, 0.5])] }];
  frame = { camera: CAMERA, clouds, widthPx: 16, heightPx: 16 };
});

describe('measureEffects', () => {
  gpuTest('measures each effect that a frame can do without, and leaves nothing behind', async () => {
    const before = engine.memory().totalBytes;
    const steps: string[] = [];
    const costs = await measureEffects(engine, frame, {
      frames: 1,
      onProgress: ({ done, total, label }) => steps.push(`${done}/${total} ${label}`),
    });
    expect(engine.memory().totalBytes).toBe(before);
    expect(costs.map(({ name }) => name)).toEqual(['harmonics', 'tint']);
    expect(steps[0]).toBe('0/2 Timing View-dependent colour');
    expect(steps.at(-1)).toBe('1/2 Timing Tint');
  });

  gpuTest('compares frames that are drawn in the same buffers', async () => {
    const createBuffer = vi.spyOn(device, 'createBuffer');
    await measureEffects(engine, frame, { frames: 1 });
    const labels = createBuffer.mock.calls.map(([{ label }]) => label);
    createBuffer.mockRestore();
    for (const label of ['frame records', 'frame visibleSplats'])
      expect(labels.filter((made) => made === label)).toEqual([label]);
  });

  gpuTest('ends when its signal is aborted', async () => {
    const before = engine.memory().totalBytes;
    const ended = new AbortController();
    const measured = measureEffects(engine, frame, {
      signal: ended.signal,
      onProgress: () => ended.abort(new Error('enough')),
    });
    await expect(measured).rejects.toThrow('enough');
    expect(engine.memory().totalBytes).toBe(before);
    await expect(measureEffects(engine, frame, { frames: 0 })).rejects.toThrow(InvalidArgumentError);
  });
});
