import type { FrameStatistics } from '@websplatter/core';
import { afterEach, describe, expect, it, vi } from 'vitest';
import { detailOfFrames } from '../../state/accuracy.ts';
import { createViewerStore, type ViewerState } from '../../state/store.ts';
import { observeWholeFrames, WholeFrames } from './whole-frames.ts';

const scene = (title: string) => ({ title }) as ViewerState['scene'];

afterEach(() => void vi.restoreAllMocks());

/** A store with a scene, and a function that draws three frames, each so long after the last. */
function setUp() {
  const store = createViewerStore();
  let nowMs = 0;
  vi.spyOn(performance, 'now').mockImplementation(() => nowMs);
  const cloud = { hasLevels: true };
  observeWholeFrames(store, () => cloud.hasLevels);
  store.setState({ scene: scene('a') });
  const measure = (totalMs: number, everyMs = totalMs, cutErrorPx: number | null = null) => {
    for (let frame = 0; frame < 3; frame++) {
      nowMs += everyMs;
      store.setState({ statistics: { cutErrorPx, timing: { totalMs } } as FrameStatistics });
    }
    return store.getState().wholeFrameMs;
  };
  const detail = () => detailOfFrames(store.getState());
  return { store, cloud, measure, detail };
}

it('a device is slow by the median of three frames, until they are clearly quick again', () => {
  const frames = new WholeFrames();
  const slowAfter = (...timesMs: number[]) => {
    for (const timeMs of timesMs) frames.add(timeMs);
    return frames.slowMs;
  };
  expect(slowAfter(180, 180)).toBeNull();
  expect(slowAfter(20)).toBe(180);
  expect(slowAfter(30, 30, 30)).toBe(180);
  expect(slowAfter(70, 60)).toBe(60);
  expect(slowAfter(10, 10)).toBeNull();
  expect(slowAfter(45, 45, 45, 90)).toBeNull();
});

describe('frames in motion', () => {
  it('are coarser where whole ones are slow, unless a detail was chosen or two are compared', () => {
    const { store, measure, detail } = setUp();
    expect([measure(50), detail()]).toEqual([null, 'full']);
    expect([measure(180), detail()]).toEqual([180, { maxFrameMs: 50 }]);
    for (const chosen of ['full', { maxSplats: 5 }] as const) {
      store.setState({ detail: chosen, isDetailChosen: true });
      expect(detail()).toBe(chosen);
    }
    store.setState({ detail: 'full', isDetailChosen: false });
    store.setState({ comparison: { kind: 'split', left: 'current', right: 'current' } });
    expect(detail()).toBe('full');
    store.setState({ comparison: null });
    expect(detail()).toEqual({ maxFrameMs: 50 });
  });

  it('are judged by neither waits in a queue nor single or coarse frames, and by whole ones at rest', () => {
    const { measure } = setUp();
    expect(measure(60, 30), 'two in flight').toBeNull();
    expect(measure(180, 1000), 'single').toBeNull();
    expect(measure(180, 300), 'a slow hand').toBe(180);
    expect(measure(10, 10, 0.5), 'coarse').toBe(180);
    expect(measure(90, 1000)).toBe(90);
    expect(measure(20, 1000)).toBeNull();
  });

  it('are whole while a file loads, of a new scene, and where there can be no fewer splats', () => {
    const { store, cloud, measure } = setUp();
    store.setState({ load: {} as ViewerState['load'] });
    expect(measure(180)).toBeNull();
    store.setState({ load: null });
    expect(measure(180)).toBe(180);
    store.setState({ scene: scene('b') });
    expect(store.getState().wholeFrameMs).toBeNull();
    expect(measure(180)).toBe(180);
    cloud.hasLevels = false;
    expect(measure(180)).toBeNull();
  });
});
