import type { SplatEngine, StreamReport } from '@websplatter/core';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { createViewerStore } from '../state/store.ts';
import { followStreams } from './stream-panel.tsx';

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  expect(vi.getTimerCount(), 'timers left').toBe(0);
  vi.useRealTimers();
});

function fakeCloud(report: Partial<StreamReport>) {
  const listeners = new Set<() => void>();
  const subscribe = (listener: () => void) => {
    listeners.add(listener);
    return () => listeners.delete(listener);
  };
  const cloud = { stream: { report: () => report, subscribe } };
  const change = (changed: Partial<StreamReport>) => {
    report = { ...report, ...changed };
    for (const listener of [...listeners]) listener();
  };
  return { cloud, change, listeners };
}

const COUNTS = { bricks: 10, residentBricks: 2, missingBricks: 3, fetchedBytes: 100, bytesPerSecond: 0 };
const REPORT = { ...COUNTS, fetching: 0, error: null };

it('adds up what streams, a moment after it changes, and again while anything is fetched', () => {
  const store = createViewerStore();
  const [one, two] = [fakeCloud(REPORT), fakeCloud(REPORT)];
  const clouds: object[] = [{ stream: null }];
  const stop = followStreams(store, () => ({ clouds }) as unknown as SplatEngine);
  const streaming = () => store.getState().streaming;
  expect(streaming()).toBeNull();
  clouds.push(one.cloud, two.cloud);
  store.setState({ scene: {} as never });
  vi.advanceTimersByTime(250);
  const before = streaming();
  expect(before).toEqual({
    bricks: 20,
    residentBricks: 4,
    missingBricks: 6,
    fetchedBytes: 200,
    bytesPerSecond: 0,
    error: null,
  });
  for (let i = 0; i < 3; i++) one.change({});
  vi.advanceTimersByTime(250);
  expect(streaming()).toBe(before);
  expect(vi.getTimerCount()).toBe(0);
  const error = new Error('the server is gone');
  two.change({ fetching: 1, bytesPerSecond: 7, error });
  vi.advanceTimersByTime(250);
  expect(streaming()).toMatchObject({ bytesPerSecond: 7, error });
  expect(vi.getTimerCount()).toBe(1);
  stop();
  expect(one.listeners.size + two.listeners.size).toBe(0);
});
