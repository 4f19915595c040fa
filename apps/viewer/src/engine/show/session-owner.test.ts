import {
  CodeUnavailableError,
  DestroyedError,
  type SplatEngine,
  WebGpuUnavailableError,
} from '@websplatter/core';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { createViewerStore, type ViewerStore } from '../../state/store.ts';
import { SessionOwner } from './session-owner.ts';

const canvas = {} as HTMLCanvasElement;
const NO_GPU = new WebGpuUnavailableError('WebGPU found no GPU that it may use.');

let store: ViewerStore;
let sessions: SessionOwner;
const onStart = vi.fn();
const onEnd = vi.fn();
/** One of the engines that were asked for. */
let loseDevice: () => Promise<unknown>;
const createEngine = vi.fn<typeof SplatEngine.create>();

beforeEach(() => {
  vi.useFakeTimers();
  onStart.mockClear();
  createEngine.mockReset();
  createEngine.mockImplementation(async () => {
    let lose = (_info: GPUDeviceLostInfo) => {};
    const lost = new Promise<GPUDeviceLostInfo>((resolve) => {
      lose = resolve;
    });
    loseDevice = () => {
      lose({ message: 'The driver was reset.' } as GPUDeviceLostInfo);
      return passMs(0);
    };
    const device = { addEventListener: () => {} };
    return {
      lost,
      device,
      adapterLabel: 'fake',
      destroy: vi.fn(),
      createView: () => ({}),
    } as unknown as SplatEngine;
  });
  store = createViewerStore();
  const events = { onStart, onEnd, onAccuracyChosen: () => {} };
  sessions = new SessionOwner(store, events, createEngine);
});
afterEach(() => void vi.useRealTimers());

function passMs(durationMs: number): Promise<unknown> {
  return vi.advanceTimersByTimeAsync(durationMs);
}

describe('SessionOwner', () => {
  it('asks for the GPU before there is a canvas, if told to, and not once more for the first', async () => {
    sessions.prepare();
    expect(createEngine).toHaveBeenCalledTimes(1);
    expect(onStart).not.toHaveBeenCalled();
    const detach = sessions.attach(canvas);
    await passMs(0);
    expect(onStart).toHaveBeenCalledTimes(1);
    expect(createEngine).toHaveBeenCalledTimes(1);
    detach();
    sessions.attach(canvas);
    await passMs(0);
    expect(createEngine).toHaveBeenCalledTimes(2);
  });

  it('says why there is no GPU once there is a canvas, where it was asked for before', async () => {
    createEngine.mockRejectedValueOnce(NO_GPU);
    sessions.prepare();
    await passMs(0);
    expect(store.getState().status).toBe('starting');
    sessions.attach(canvas);
    await passMs(0);
    expect(store.getState()).toMatchObject({
      status: 'unavailable',
      statusReason: NO_GPU.message,
      isCodeMissing: false,
    });
  });

  it('tells a GPU that is not there from code that is not there', async () => {
    const log = vi.spyOn(console, 'error').mockImplementation(() => {});
    const error = new CodeUnavailableError('engine', { cause: new TypeError('offline') });
    createEngine.mockRejectedValueOnce(error);
    sessions.attach(canvas);
    await passMs(0);
    expect(store.getState()).toMatchObject({
      status: 'unavailable',
      statusReason: error.message,
      isCodeMissing: true,
    });
    expect(log).toHaveBeenCalledExactlyOnceWith(error);
    log.mockRestore();
  });

  /**
   * @fault Devices and engines: the device is lost again and again in the viewer
   * @consequence the viewer recovers by itself, and at last shows a page with a button
   */
  it('asks for a lost GPU again by itself, at once and then ever more slowly, and then leaves it to a person', async () => {
    sessions.attach(canvas);
    await passMs(0);
    const { current } = sessions;
    await loseDevice();
    expect(store.getState()).toMatchObject({ status: 'running', retryWaitMs: null });
    expect(store.getState().notice).toContain('lost');
    expect(sessions.current).not.toBe(current);
    for (const [attempts, waitMs] of [1000, 4000, 16_000].entries()) {
      await loseDevice();
      expect(store.getState()).toMatchObject({
        status: 'lost',
        statusReason: 'The driver was reset.',
        retryWaitMs: waitMs,
      });
      await passMs(waitMs - 1);
      expect(createEngine).toHaveBeenCalledTimes(attempts + 2);
      await passMs(1);
      expect(store.getState()).toMatchObject({ status: 'running', statusReason: '', retryWaitMs: null });
    }
    await loseDevice();
    await passMs(1e6);
    expect(store.getState()).toMatchObject({ status: 'lost', retryWaitMs: null });
    sessions.recover();
    await passMs(0);
    expect(store.getState().status).toBe('running');
    expect(onStart).toHaveBeenCalledTimes(6);
    expect(createEngine).toHaveBeenCalledTimes(6);
  });

  it('goes on asking where there is no GPU at that moment', async () => {
    sessions.attach(canvas);
    await passMs(0);
    createEngine.mockRejectedValueOnce(NO_GPU);
    store.setState({ isHelpVisible: true });
    await loseDevice();
    expect(store.getState()).toMatchObject({
      status: 'lost',
      statusReason: NO_GPU.message,
      retryWaitMs: 1000,
      // The page that says so comes in its place.
      isHelpVisible: false,
    });
    const statuses: unknown[] = [];
    store.subscribe((state) => statuses.push(state.status));
    await passMs(1000);
    // The page stays meanwhile.
    expect(statuses).toEqual(['recovering', 'running']);
  });

  it('begins anew where a whole image has been on the screen for a minute, however long it took to get there', async () => {
    sessions.attach(canvas);
    await passMs(0);
    await loseDevice();
    await passMs(300_000);
    await loseDevice();
    expect(store.getState().retryWaitMs).toBe(1000);
    await passMs(300_000);
    sessions.confirmRecovery();
    await passMs(59_000);
    await loseDevice();
    expect(store.getState().retryWaitMs).toBe(4000);
    await passMs(300_000);
    sessions.confirmRecovery();
    await passMs(61_000);
    await loseDevice();
    expect(store.getState().status).toBe('running');
    await loseDevice();
    expect(store.getState().retryWaitMs).toBe(1000);
  });

  it('ends loads that wait for a GPU where there is none again', async () => {
    sessions.attach(canvas);
    await passMs(0);
    createEngine.mockRejectedValueOnce(NO_GPU);
    onEnd.mockClear();
    await loseDevice();
    expect(onEnd).toHaveBeenCalledTimes(2);
  });

  /**
   * @fault Devices and engines: a new device is lost before it is used
   * @consequence the viewer tries again
   */
  it('goes on asking where the new device is lost before it is used', async () => {
    sessions.attach(canvas);
    await passMs(0);
    const destroy = vi.fn();
    const createView = () => {
      throw new DestroyedError('This engine', 'the GPU device was lost');
    };
    const device = { addEventListener: () => {} };
    createEngine.mockResolvedValueOnce({ device, createView, destroy } as unknown as SplatEngine);
    await loseDevice();
    expect(store.getState()).toMatchObject({ status: 'lost', retryWaitMs: 1000 });
    expect(destroy).toHaveBeenCalledOnce();
    await passMs(1000);
    expect(store.getState().status).toBe('running');
  });

  it('a person need not wait', async () => {
    sessions.attach(canvas);
    await passMs(0);
    await loseDevice();
    await loseDevice();
    expect(store.getState().status).toBe('lost');
    sessions.recover();
    await passMs(20_000);
    expect(store.getState().status).toBe('running');
    expect(createEngine).toHaveBeenCalledTimes(3);
  });

  it('says so where there has been no GPU at all, and tries again with another canvas', async () => {
    createEngine.mockRejectedValueOnce(NO_GPU);
    const detach = sessions.attach(canvas);
    await passMs(20_000);
    expect(store.getState()).toMatchObject({ status: 'unavailable', statusReason: NO_GPU.message });
    detach();
    sessions.recover();
    expect(store.getState().status).toBe('starting');
    sessions.attach(canvas);
    await passMs(0);
    expect(store.getState().status).toBe('running');
  });

  it('asks for nothing any more once the canvas is gone', async () => {
    const detach = sessions.attach(canvas);
    await passMs(0);
    await loseDevice();
    await loseDevice();
    detach();
    await passMs(20_000);
    expect(createEngine).toHaveBeenCalledTimes(2);
    expect(vi.getTimerCount()).toBe(0);
  });
});
