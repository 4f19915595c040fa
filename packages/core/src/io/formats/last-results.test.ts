import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { LastResults } from './last-results.ts';

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

test('results are made once while they fit, and the one used longest ago goes first', async () => {
  const results = new LastResults<number>(100, (bytes) => bytes);
  const made: number[] = [];
  const get = (key: number, bytes: number) =>
    results.get(key, async () => {
      made.push(key);
      return bytes;
    });
  await Promise.all([get(1, 50), get(1, 50)]);
  await get(2, 50);
  await get(1, 50);
  await get(3, 50);
  await get(1, 50);
  expect(made).toEqual([1, 2, 3]);
  await get(2, 50);
  expect(made).toEqual([1, 2, 3, 2]);
  await get(4, 1000);
  await get(4, 1000);
  expect(made).toEqual([1, 2, 3, 2, 4]);
});

test('no more than four are kept, however small', async () => {
  const results = new LastResults<number>(100, (bytes) => bytes);
  const make = vi.fn(async () => 1);
  for (const key of [1, 2, 3, 4, 5, 5, 4, 3, 2]) await results.get(key, make);
  expect(make).toHaveBeenCalledTimes(5);
  await results.get(1, make);
  expect(make).toHaveBeenCalledTimes(6);
});

test('results go two seconds after their last use', async () => {
  const results = new LastResults<string>(100, () => 1);
  const make = vi.fn(async () => 'made');
  await results.get(1, make);
  await vi.advanceTimersByTimeAsync(1500);
  await results.get(1, make);
  await vi.advanceTimersByTimeAsync(1500);
  await results.get(1, make);
  expect(make).toHaveBeenCalledTimes(1);
  await vi.advanceTimersByTimeAsync(2000);
  await results.get(1, make);
  expect(make).toHaveBeenCalledTimes(2);
});

test('one that failed is made again, by a call that waited for it too', async () => {
  const results = new LastResults<string>(100, () => 1);
  const failing = results.get(1, () => Promise.reject(new Error('aborted')));
  const waiting = results.get(1, async () => 'made');
  await expect(failing).rejects.toThrow('aborted');
  expect(await waiting).toBe('made');
  await expect(results.get(2, () => Promise.reject(new Error('damaged')))).rejects.toThrow('damaged');
  expect(await results.get(2, async () => 'made')).toBe('made');
});
