import {
  type AccuracyChoice,
  type FrameStatistics,
  type SplatEngine,
  WebSplatterError,
} from '@websplatter/core';
import { beforeEach, expect, onTestFinished, test, vi } from 'vitest';
import { SplatCloudObject } from './cloud/splat-cloud-object.ts';
import { SplatLoader } from './cloud/splat-loader.ts';
import { type FrameLoader, SplatSequence } from './cloud/splat-sequence.ts';
import { attachEngine, onDeviceLost } from './renderer/adopt-renderer.ts';
import { onStageTimings, reportStageTimings } from './renderer/stage-timings.ts';
import { splatDataAt } from './testing/test-clouds.ts';

const error = new Error('of a listener');
const bad = () => {
  throw error;
};

let reported: unknown[];
beforeEach(() => {
  reported = [];
  vi.stubGlobal('reportError', (each: unknown) => reported.push(each));
  onTestFinished(() => void vi.unstubAllGlobals());
});

test('an error of one that follows stage timings is reported, and others are told', () => {
  const renderer = {};
  const told = vi.fn();
  onStageTimings(renderer, bad);
  const stop = onStageTimings(renderer, told);
  const statistics = {} as FrameStatistics;
  reportStageTimings(renderer, statistics);
  stop();
  reportStageTimings(renderer, statistics);
  expect(told.mock.calls).toEqual([[statistics]]);
  expect(reported).toEqual([error, error]);
});

test('an error of one that follows the device is reported, and others are told', async () => {
  const info = { reason: 'unknown', message: 'gone' } as GPUDeviceLostInfo;
  const renderer = { dispose: async () => {} };
  const engine = { lost: Promise.resolve(info), destroy: () => {} } as unknown as SplatEngine;
  const told = vi.fn();
  attachEngine(renderer as never, engine, 'full');
  onDeviceLost(renderer, bad);
  onDeviceLost(renderer, told);
  await engine.lost;
  await null;
  expect(told.mock.calls).toEqual([[info]]);
  expect(reported).toEqual([error]);
});

test('errors of listeners of a cloud are reported, once its change is over', async () => {
  const cloud = new SplatCloudObject(splatDataAt([0, 0, 0]));
  cloud.onError = bad;
  cloud.addEventListener('needsframe', bad);
  cloud.addEventListener('firstframe', bad);
  cloud.requestFrame();
  expect(reported.splice(0)).toEqual([error]);
  expect(cloud.tell(new Error('of a frame'))).toBe(true);
  cloud.announceDrawn(0, []);
  expect(reported).toEqual([]);
  await null;
  expect(new Set(reported)).toEqual(new Set([error]));
});

/**
 * @fault Listeners: a listener of three.js or a function of a `SplatSequence` throws, or ends the sequence
 * @consequence the error is reported; sequence, clouds and device go on, and other listeners are called,
 *   such as those that draw the next frame
 */
test('an error of one that follows a cloud or a sequence keeps no other from being told', async () => {
  const cloud = new SplatCloudObject();
  const told: unknown[] = [];
  const tell = (event: { readonly type: string }) => void told.push(event.type);
  for (const type of ['needsframe', 'firstframe', 'complete', 'accuracychosen'] as const) {
    cloud.addEventListener(type, bad);
    cloud.addEventListener(type, tell);
  }
  cloud.data = splatDataAt([0, 0, 0]);
  cloud.announceDrawn(0, []);
  cloud.announceAccuracy({} as AccuracyChoice);
  await null;
  expect(told.sort()).toEqual(['accuracychosen', 'complete', 'firstframe', 'needsframe']);
  const loadAsync = async () => splatDataAt([0, 0, 0]);
  const sequence = new SplatSequence(['0'], () => ({ loadAsync, abort: () => {} }) as unknown as FrameLoader);
  sequence.addEventListener('change', bad);
  const target = new Promise((resolve) =>
    sequence.addEventListener('change', (event) => resolve(event.target)),
  );
  expect(await target).toBe(sequence);
  sequence.dispose();
});

test('errors of callbacks of a loader are reported', async () => {
  const load = (source: Blob) =>
    new Promise<unknown>((resolve) => {
      const loader = new SplatLoader();
      const onEnd = (result: unknown) => {
        resolve(result);
        throw error;
      };
      loader.load(source, onEnd, bad, onEnd);
    });
  expect(await load(new Blob(['no splats']))).toBeInstanceOf(WebSplatterError);
  await null;
  expect(reported).toContain(error);
});

test('errors of functions of a sequence are reported, and it goes on', async () => {
  const log = vi.spyOn(console, 'error').mockImplementation(() => {});
  onTestFinished(() => log.mockRestore());
  const gone = new Error('gone');
  const failing = new Error('of a loader');
  const aborts = vi.fn(bad);
  const loaded: string[] = [];
  const makeLoader = (): FrameLoader => {
    const number = loaded.push('made') - 1;
    if (number === 0) throw failing;
    const loadAsync = () => (number === 1 ? Promise.reject(gone) : new Promise<never>(() => {}));
    return { loadAsync, abort: aborts } as unknown as FrameLoader;
  };
  const sequence = new SplatSequence(['0', '1', '2', '3'], makeLoader);
  const told: unknown[] = [];
  sequence.onError = (cause, frame) => {
    told.push([cause, frame]);
    throw error;
  };
  sequence.addEventListener('change', bad);
  await expect.poll(() => told).toHaveLength(2);
  expect(told).toEqual([
    [failing, 0],
    [gone, 1],
  ]);
  await expect.poll(() => loaded).toHaveLength(4);
  expect(reported.length).toBeGreaterThanOrEqual(2);
  sequence.dispose();
  // Both loads that are under way.
  expect(aborts).toHaveBeenCalledTimes(2);
  expect(new Set(reported)).toEqual(new Set([error]));
});

test('a sequence may end in any of its functions', async () => {
  const loadAsync = vi.fn(() => new Promise<never>(() => {}));
  const sequence: SplatSequence = new SplatSequence(['0', '1', '2'], () => {
    sequence.dispose();
    return { loadAsync, abort: () => {} } as unknown as FrameLoader;
  });
  await null;
  await null;
  await null;
  sequence.seek({ frame: 2 });
  await null;
  expect(sequence.data).toBeNull();
  expect(loadAsync).not.toHaveBeenCalled();
  expect(reported).toEqual([]);
});
