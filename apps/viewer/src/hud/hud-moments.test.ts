import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { createViewerStore } from '../state/store.ts';
import { FrameRecorder } from './frame-recorder.ts';
import { FIGURES_INTERVAL_MS, hudMoments } from './hud-moments.ts';

function started(isLarge = false) {
  const store = createViewerStore();
  const recorder = new FrameRecorder(store);
  recorder.watch();
  const engine = vi.fn(() => null);
  const moments = hudMoments({ store, recorder, engine }, isLarge);
  const onChange = vi.fn();
  const stop = moments.subscribe(onChange);
  return { store, moments, onChange, stop, engine };
}

describe('moments of the figures', () => {
  beforeEach(() => {
    vi.useFakeTimers();
  });
  afterEach(() => {
    vi.useRealTimers();
  });

  it('are as rare as figures can be read, the last state included', () => {
    const { store, moments, onChange } = started();
    for (let widthPx = 1; widthPx <= 100; widthPx++) {
      store.setState({ widthPx });
      vi.advanceTimersByTime(10);
    }
    expect(onChange).toHaveBeenCalledTimes(1000 / FIGURES_INTERVAL_MS);
    store.setState({ widthPx: 200 });
    vi.advanceTimersByTime(FIGURES_INTERVAL_MS);
    expect(moments.getSnapshot().state.widthPx).toBe(200);
  });

  it('follow only state that figures show, and end with their subscription', () => {
    const { store, moments, onChange, stop } = started();
    const first = moments.getSnapshot();
    store.setState({ notice: 'Hello' });
    vi.advanceTimersByTime(10 * FIGURES_INTERVAL_MS);
    expect(onChange).not.toHaveBeenCalled();
    expect(moments.getSnapshot()).toBe(first);
    store.setState({ widthPx: 5 });
    stop();
    vi.advanceTimersByTime(10 * FIGURES_INTERVAL_MS);
    expect(onChange).not.toHaveBeenCalled();
  });

  it('stand still while frozen, from the instant on', () => {
    const { store, moments, onChange } = started();
    store.setState({ widthPx: 5 });
    store.setState({ isHudFrozen: true });
    expect(onChange).toHaveBeenCalledTimes(1);
    store.setState({ widthPx: 6 });
    vi.advanceTimersByTime(10 * FIGURES_INTERVAL_MS);
    expect(moments.getSnapshot().state.widthPx).toBe(5);
    store.setState({ isHudFrozen: false });
    expect(moments.getSnapshot().state.widthPx).toBe(6);
  });

  it('list memory once a second, for the largest size alone', () => {
    const small = started();
    const large = started(true);
    for (let step = 1; step <= 8; step++) {
      for (const { store } of [small, large]) store.setState({ widthPx: step });
      vi.advanceTimersByTime(FIGURES_INTERVAL_MS);
    }
    expect(small.engine).not.toHaveBeenCalled();
    expect(large.engine).toHaveBeenCalledTimes(3);
    expect(large.moments.getSnapshot().large?.frames).toEqual({ left: [], right: [] });
  });

  it('list memory once more at rest, for what has gone since it was listed', () => {
    const { store, engine } = started(true);
    vi.advanceTimersByTime(2000);
    store.setState({ widthPx: 1 });
    vi.advanceTimersByTime(FIGURES_INTERVAL_MS);
    const listed = engine.mock.calls.length;
    store.setState({ widthPx: 2 });
    vi.advanceTimersByTime(FIGURES_INTERVAL_MS);
    expect(engine).toHaveBeenCalledTimes(listed);
    vi.advanceTimersByTime(1000);
    expect(engine).toHaveBeenCalledTimes(listed + 1);
    vi.advanceTimersByTime(10_000);
    expect(engine).toHaveBeenCalledTimes(listed + 1);
  });
});
