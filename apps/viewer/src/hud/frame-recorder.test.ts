import type { FrameStatistics } from '@websplatter/core';
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { createViewerStore, type ViewerState } from '../state/store.ts';
import { FrameRecorder, HISTORY_FRAMES, Ring } from './frame-recorder.ts';

function setUp() {
  const store = createViewerStore();
  const recorder = new FrameRecorder(store);
  const stop = recorder.watch();
  const numbers = (side: 'left' | 'right') => recorder.frames(side).map(({ frame }) => frame);
  return { store, recorder, stop, numbers };
}

const statistics = (frame: number) => ({ frame }) as FrameStatistics;
const scene = (contentKey: string) => ({ contentKey }) as ViewerState['scene'];

describe('the record of the last frames', () => {
  it('has each frame of both sides once, whatever else changes', () => {
    const { store, numbers, stop } = setUp();
    for (let frame = 1; frame <= HISTORY_FRAMES + 2; frame++) {
      store.setState({ statistics: statistics(frame) });
      store.setState({ isIdle: frame % 2 === 0 });
    }
    store.setState({ rightStatistics: statistics(7) });
    expect(numbers('left')).toHaveLength(HISTORY_FRAMES);
    expect(numbers('left').at(0)).toBe(3);
    expect(numbers('right')).toEqual([7]);
    stop();
    store.setState({ statistics: statistics(1000) });
    expect(numbers('left').at(-1)).toBe(HISTORY_FRAMES + 2);
  });

  it('has what calls and the figures themselves took of each frame', () => {
    const { store, recorder } = setUp();
    store.setState({ lastRender: { elapsedMs: 0.5 } });
    store.setState({ lastRender: { elapsedMs: 0.5 } });
    recorder.spend(100);
    store.setState({ statistics: statistics(1) });
    store.setState({ lastRender: { elapsedMs: 0.25 } });
    store.setState({ statistics: statistics(2) });
    expect(recorder.renderMs).toEqual([1, 0.25]);
    const [busy, idle] = recorder.ownMs;
    expect(busy).toBeGreaterThanOrEqual(100);
    expect(idle).toBeLessThan(100);
  });

  it('stands still while the figures are frozen, and so does the state that they tell', () => {
    const { store, recorder, numbers } = setUp();
    store.setState({ statistics: statistics(1) });
    store.setState({ isHudFrozen: true });
    store.setState({ statistics: statistics(2), lastRender: { elapsedMs: 1 } });
    expect(numbers('left')).toEqual([1]);
    expect(recorder.shown.statistics?.frame).toBe(1);
    expect(recorder.renderMs).toEqual([0]);
    store.setState({ isHudFrozen: false });
    store.setState({ statistics: statistics(3) });
    expect(numbers('left')).toEqual([1, 3]);
    expect(recorder.renderMs, 'without the calls of frames that were not recorded').toEqual([0, 0]);
    expect(recorder.shown.statistics?.frame).toBe(3);
  });

  it('begins anew with another scene, and its right side with another split image', () => {
    const { store, numbers } = setUp();
    store.setState({ scene: scene('a'), statistics: statistics(1), rightStatistics: statistics(1) });
    store.setState({ rightStatistics: null });
    store.setState({ rightStatistics: statistics(2) });
    expect(numbers('right')).toEqual([2]);
    // The next frame of a moving scene, or a file that was moved, is of the same scene.
    store.setState({ scene: scene('a') });
    expect(numbers('right')).toEqual([2]);
    store.setState({ scene: scene('b') });
    expect(numbers('left')).toEqual([]);
    expect(numbers('right')).toEqual([]);
  });

  it('has another revision when its frames change, not otherwise', () => {
    const { store, recorder } = setUp();
    const { revision } = recorder;
    store.setState({ isIdle: false });
    expect(recorder.revision).toBe(revision);
    store.setState({ statistics: statistics(1) });
    expect(recorder.revision).not.toBe(revision);
  });
});

describe('a ring', () => {
  it('keeps the last values in their order', () => {
    fc.assert(
      fc.property(fc.array(fc.integer()), fc.integer({ min: 1, max: 8 }), (values, capacity) => {
        const ring = new Ring<number>(capacity);
        for (const value of values) ring.push(value);
        expect(ring.toArray()).toEqual(values.slice(-capacity));
      }),
    );
  });

  it('begins anew when it is cleared', () => {
    const ring = new Ring<number>(2);
    for (const value of [1, 2, 3]) ring.push(value);
    ring.clear();
    expect(ring.toArray()).toEqual([]);
    ring.push(4);
    expect(ring.toArray()).toEqual([4]);
  });
});
