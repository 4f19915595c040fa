import { beforeEach, expect, onTestFinished, test, vi } from 'vitest';
import { FirstPicture } from './canvas-states.ts';
import { requestFor, SplatCache } from './splat-cache.ts';
import { mountSplatDevice, setSplatDevice, watchSplatDevice } from './splat-device.ts';

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

/**
 * @fault Listeners: a listener of React throws
 * @consequence the error is reported; the cache and the state of the device go on
 */
test('an error of one that watches the device is reported, and others are told', () => {
  const owner = {};
  const told = vi.fn();
  const stops = [watchSplatDevice(bad), watchSplatDevice(told)];
  setSplatDevice(owner, 'pending');
  const unmount = mountSplatDevice(owner);
  unmount();
  for (const stop of stops) stop();
  expect(told).toHaveBeenCalledTimes(2);
  expect(reported).toEqual([error, error]);
});

test('an error of one that watches a file is reported, and ends neither its load nor others', async () => {
  let onProgress: (event: ProgressEvent) => void = () => {};
  let resolve: (data: string) => void = () => {};
  const cache = new SplatCache<string>(
    (_, watch) => {
      ({ onProgress } = watch);
      return new Promise((give) => {
        resolve = give;
      });
    },
    () => {},
  );
  const request = requestFor('https://example.org/a.ply');
  const told = { onChange: vi.fn(), onProgress: vi.fn() };
  const stops = [cache.watch(request, { onChange: bad, onProgress: bad }), cache.watch(request, told)];
  onProgress({} as ProgressEvent);
  resolve('a');
  await expect.poll(() => told.onChange.mock.calls).toHaveLength(1);
  expect(told.onProgress).toHaveBeenCalledTimes(1);
  expect(cache.stateOf(request)).toEqual({ status: 'loaded', data: 'a' });
  expect(reported).toEqual([error, error]);
  for (const stop of stops) stop();
  cache.clear();
});

test('a first picture is told once, also to one that throws', () => {
  const tell = vi.fn(bad);
  const picture = new FirstPicture(tell);
  expect(() => picture.drawn()).toThrow(error);
  picture.drawn();
  expect(tell).toHaveBeenCalledTimes(1);
});
