import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { FrameLoop } from './frame-loop.ts';

/** A screen that refreshes when told to, and a GPU that is done when told to. */
function setUp() {
  const callbacks = new Map<number, FrameRequestCallback>();
  let handles = 0;
  vi.stubGlobal('requestAnimationFrame', (callback: FrameRequestCallback) => {
    callbacks.set(++handles, callback);
    return handles;
  });
  vi.stubGlobal('cancelAnimationFrame', (handle: number) => callbacks.delete(handle));
  const finish: (() => void)[] = [];
  const draw = vi.fn<(elapsedMs: number) => Promise<unknown> | null>(
    () => new Promise<void>((resolve) => finish.push(resolve)),
  );
  const onDrawn = vi.fn();
  const onIdle = vi.fn();
  const loop = new FrameLoop({ draw, onDrawn, onIdle });
  const refresh = (nowMs: number) => {
    const due = [...callbacks.values()];
    callbacks.clear();
    for (const callback of due) callback(nowMs);
  };
  const finishOldest = async () => {
    finish.shift()?.();
    await Promise.resolve();
    await Promise.resolve();
  };
  return { loop, draw, onDrawn, onIdle, refresh, finishOldest, pending: () => callbacks.size };
}

describe('FrameLoop', () => {
  let test: ReturnType<typeof setUp>;
  beforeEach(() => {
    test = setUp();
  });
  afterEach(() => {
    vi.unstubAllGlobals();
  });

  it('draws once per refresh however often it is asked', () => {
    test.loop.request();
    test.loop.request();
    test.refresh(0);
    expect(test.draw).toHaveBeenCalledOnce();
    test.refresh(16);
    expect(test.draw).toHaveBeenCalledOnce();
  });

  it('is idle after the last frame is done, with nothing pending', async () => {
    expect(test.loop.isResting).toBe(true);
    test.loop.request();
    // At once: the image before must not be taken for the next one.
    expect(test.loop.isResting).toBe(false);
    test.refresh(0);
    expect(test.onIdle).not.toHaveBeenCalled();
    expect(test.loop.isResting).toBe(false);
    await test.finishOldest();
    expect(test.onDrawn).toHaveBeenCalledOnce();
    expect(test.onIdle).toHaveBeenCalledOnce();
    expect(test.loop.isResting).toBe(true);
    expect(test.pending()).toBe(0);
  });

  it('is idle at once where nothing had changed', () => {
    test.draw.mockReturnValue(null);
    test.loop.request();
    test.refresh(0);
    expect(test.onIdle).toHaveBeenCalledOnce();
    expect(test.onDrawn).not.toHaveBeenCalled();
  });

  it('keeps two frames on their way and remembers that a third is wanted', async () => {
    for (const nowMs of [0, 16]) {
      test.loop.request();
      test.refresh(nowMs);
    }
    test.loop.request();
    expect(test.pending()).toBe(0);
    test.refresh(32);
    expect(test.draw).toHaveBeenCalledTimes(2);
    await test.finishOldest();
    test.refresh(48);
    expect(test.draw).toHaveBeenCalledTimes(3);
  });

  it('gives the time since the last frame, and that of one frame after a pause', async () => {
    test.loop.request();
    test.refresh(0);
    test.loop.request();
    test.refresh(20);
    expect(test.draw).toHaveBeenLastCalledWith(20);
    await test.finishOldest();
    await test.finishOldest();
    test.loop.request();
    test.refresh(9000);
    expect(test.draw.mock.lastCall?.[0]).toBeLessThan(20);
  });

  it('forgets what was asked for when it is stopped', () => {
    test.loop.request();
    test.loop.stop();
    test.refresh(0);
    expect(test.draw).not.toHaveBeenCalled();
  });
});
