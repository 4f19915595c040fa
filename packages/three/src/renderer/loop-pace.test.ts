import type { WebGPURenderer } from 'three/webgpu';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { paceAnimationLoop } from './loop-pace.ts';

type Loop = (timeMs: number) => void;

/** A GPU that takes `frameMs` for each frame, and of which the page hears at most every `toldMs`. */
function slowQueue(frameMs: number, toldMs = 0) {
  let busyUntilMs = 0;
  return {
    onSubmittedWorkDone: (): Promise<undefined> => {
      busyUntilMs = Math.max(busyUntilMs, performance.now()) + frameMs;
      const heardMs = toldMs > 0 ? Math.ceil(busyUntilMs / toldMs) * toldMs : busyUntilMs;
      return new Promise((resolve) => setTimeout(() => resolve(undefined), heardMs - performance.now()));
    },
  };
}

function fakeRenderer(loop: Loop | null = null) {
  const state = { loop, isPresenting: false };
  const renderer = {
    xr: {
      get isPresenting() {
        return state.isPresenting;
      },
    },
    setAnimationLoop: async (next: Loop | null) => {
      state.loop = next;
    },
    getAnimationLoop: () => state.loop,
  };
  return { state, renderer: renderer as unknown as WebGPURenderer };
}

describe('an animation loop', () => {
  beforeEach(() => {
    vi.useFakeTimers();
  });
  afterEach(() => {
    vi.useRealTimers();
  });

  /** Runs a display at 60 Hz for two seconds; returns the calls of the loop in the second one. */
  async function callsPerSecond(queue: ReturnType<typeof slowQueue>): Promise<number> {
    const loop = vi.fn();
    const { renderer, state } = fakeRenderer();
    paceAnimationLoop(renderer, queue);
    await renderer.setAnimationLoop(loop);
    for (let frame = 0; frame < 120; frame++) {
      if (frame === 60) loop.mockClear();
      state.loop!(performance.now());
      await vi.advanceTimersByTimeAsync(1000 / 60);
    }
    return loop.mock.calls.length;
  }

  it('goes on at the display’s pace with a quick GPU, also where the page hears of it late', async () => {
    expect(await callsPerSecond(slowQueue(2))).toBe(60);
    expect(await callsPerSecond(slowQueue(16))).toBe(60);
    expect(await callsPerSecond(slowQueue(2, 100))).toBeGreaterThan(57);
  });

  /**
   * @fault three.js and React: an animation loop of three.js or react-three-fiber is faster than the GPU
   * @consequence at most three frames wait for a slow GPU; `pick` and `prepareRays` answer within a few
   *   frames
   */
  it('goes on at the pace of a slow GPU, and never lets more than three frames wait', async () => {
    expect(await callsPerSecond(slowQueue(50))).toBe(20);
    const queue = slowQueue(400);
    let waiting = 0;
    const most = vi.fn();
    const counted = {
      onSubmittedWorkDone: async () => {
        most(++waiting);
        await queue.onSubmittedWorkDone();
        waiting--;
      },
    };
    expect(await callsPerSecond(counted as typeof queue)).toBeGreaterThan(1);
    expect(Math.max(...most.mock.calls.flat())).toBe(3);
  });

  it('is left alone in XR', async () => {
    const loop = vi.fn();
    const { renderer, state } = fakeRenderer();
    paceAnimationLoop(renderer, slowQueue(400));
    await renderer.setAnimationLoop(loop);
    state.isPresenting = true;
    for (let frame = 0; frame < 10; frame++) state.loop!(frame);
    expect(loop).toHaveBeenCalledTimes(10);
  });

  it('is paced once, also if it was set before, set again, or the GPU is lost', async () => {
    const loop = vi.fn();
    const { renderer, state } = fakeRenderer(loop);
    const lost = { onSubmittedWorkDone: vi.fn(async () => Promise.reject(new Error('lost'))) };
    paceAnimationLoop(renderer, lost);
    paceAnimationLoop(renderer, lost);
    await renderer.setAnimationLoop(renderer.getAnimationLoop());
    for (let frame = 0; frame < 10; frame++) {
      state.loop!(frame);
      await vi.advanceTimersByTimeAsync(1);
    }
    expect(loop).toHaveBeenCalledTimes(10);
    expect(lost.onSubmittedWorkDone).toHaveBeenCalledTimes(10);
    await renderer.setAnimationLoop(null);
    expect(state.loop).toBeNull();
  });
});
