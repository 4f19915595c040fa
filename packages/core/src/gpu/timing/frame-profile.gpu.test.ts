import { gpuTest, shareBlendingDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import { frameStages } from '../../frame/frame-passes.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { testCameras } from '../../testing/test-cameras.ts';
import type { SplatView } from '../../views/splat-view.ts';
import { FrameProfile } from './frame-profile.ts';

const NO_TIMESTAMPS = 'this adapter has no timestamp-query';
const SET = randomSplats({ count: 700, seed: 12, shDegree: 1 });
const SIZE = { widthPx: 72, heightPx: 40 };
const CAMERA = testCameras(SIZE.widthPx / SIZE.heightPx).perspective;

let device: GPUDevice;
let engine: SplatEngine;
beforeAll(async () => {
  device = await shareBlendingDevice();
  engine = await SplatEngine.create({ device });
});

/** Draws a frame and returns its pixels. */
async function draw(
  view: SplatView,
  frame: Omit<Parameters<SplatView['render']>[0], 'camera' | keyof typeof SIZE>,
) {
  view.render({ ...frame, ...SIZE, camera: CAMERA, force: true });
  return (await view.readPixels()).data;
}

describe.each(['tiles', 'quads'] as const)('a profile of a frame drawn by %s', (rasterizer) => {
  gpuTest('times every stage and changes no pixel', async ({ skip }) => {
    if (!device.features.has('timestamp-query')) skip(NO_TIMESTAMPS);
    const clouds = [{ cloud: engine.add(SET) }, { cloud: engine.add(SET) }];
    const view = engine.createView();
    const accuracy = { rasterizer, resolutionScale: 0.5 };
    const whole = await draw(view, { clouds, accuracy });
    expect(Math.max(...whole)).toBeGreaterThan(0.1);
    const heldBytes = engine.memory().totalBytes;

    const profile = new FrameProfile(view.blended().context.memory);
    view.profile = profile;
    const split = await draw(view, { clouds, accuracy });
    const times = await profile.read();
    view.profile = null;
    expect(split).toEqual(whole);
    expect(await draw(view, { clouds, accuracy })).toEqual(whole);

    const expected = new Set(
      frameStages(view.shape!).map((each) => ('stage' in each ? each : each[0]).stage),
    );
    expect(new Set(times.map(({ stage }) => stage))).toEqual(expected);
    for (const { stage, dispatches, elapsedMs } of times) {
      expect(dispatches, stage).toBeGreaterThan(0);
      expect(elapsedMs, stage).toBeGreaterThanOrEqual(0);
      expect(elapsedMs, stage).toBeLessThan(60_000);
    }
    expect(times.reduce((sum, { elapsedMs }) => sum + elapsedMs, 0)).toBeGreaterThan(0);
    const of = (part: string, stage: string) =>
      times.find((time) => time.part === part && time.stage === stage);
    // A dispatch for each cloud's page, and a sort of at least one pass.
    expect(of('pre-process', 'project')).toMatchObject({ dispatches: 2 });
    expect(of('pre-process', 'plan-cull')).toMatchObject({ dispatches: 1 });
    expect(of('sort', 'sort-scatter')!.dispatches).toBe(of('sort', 'sort-histogram')!.dispatches);
    expect(of('tile lists', 'sort-scatter') !== undefined).toBe(rasterizer === 'tiles');
    expect(of('rasterize', 'rasterize')).toMatchObject({ dispatches: 1 });

    profile.destroy();
    expect(engine.memory().totalBytes).toBe(heldBytes);
    view.destroy();
    for (const { cloud } of clouds) cloud.destroy();
  });
});

gpuTest('a profiled frame has no statistics, and the next one has', async ({ skip }) => {
  if (!device.features.has('timestamp-query')) skip(NO_TIMESTAMPS);
  const clouds = [{ cloud: engine.add(SET) }];
  const view = engine.createView();
  const frames: number[] = [];
  view.onStatistics = ({ frame }) => frames.push(frame);
  const profile = new FrameProfile(view.blended().context.memory);
  view.profile = profile;
  await draw(view, { clouds });
  await profile.read();
  view.profile = null;
  await draw(view, { clouds });
  await device.queue.onSubmittedWorkDone();
  await expect.poll(() => frames).toEqual([2]);
  profile.destroy();
  view.destroy();
  clouds[0].cloud.destroy();
});
