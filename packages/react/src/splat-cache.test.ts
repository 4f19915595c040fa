import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import {
  GRACE_MS,
  requestFor,
  SplatCache,
  type SplatFileSource,
  type SplatRequest,
  UNCLAIMED_GRACE_MS,
} from './splat-cache.ts';

interface Load {
  readonly request: SplatRequest;
  readonly signal: AbortSignal;
  readonly onProgress: (progress: ProgressEvent) => void;
  readonly onPreview: (preview: string) => void;
  readonly resolve: (data: string) => void;
  readonly reject: (error: Error) => void;
}

/** A cache whose loads end when the test resolves or rejects them. */
function testCache() {
  const loads: Load[] = [];
  const dispose = vi.fn<(data: string) => void>();
  const cache = new SplatCache<string>(
    (request, watch) => new Promise((resolve, reject) => loads.push({ request, ...watch, resolve, reject })),
    dispose,
  );
  return { cache, loads, dispose };
}

const request = (source: SplatFileSource) => requestFor(source);

/** Lets settled promises call back. */
const settle = () => vi.advanceTimersByTimeAsync(0);

beforeEach(() => {
  vi.useFakeTimers();
});
afterEach(() => {
  vi.useRealTimers();
});

describe('the cache of parsed files', () => {
  it('loads a source once for all watchers, and reports progress and the end to each', async () => {
    const { cache, loads } = testCache();
    const changes = vi.fn();
    const progress = vi.fn();
    cache.watch(request('https://example.org/a.ply'), { onChange: changes });
    cache.watch(request(new URL('https://example.org/b/../a.ply')), {
      onChange: changes,
      onProgress: progress,
    });
    expect(loads).toHaveLength(1);
    const step = { loaded: 1, total: 2 } as ProgressEvent;
    loads[0].onProgress(step);
    expect(progress).toHaveBeenCalledExactlyOnceWith(step);
    loads[0].resolve('a');
    await settle();
    expect(changes).toHaveBeenCalledTimes(2);
    expect(cache.stateOf(request('https://example.org/a.ply'))).toEqual({ status: 'loaded', data: 'a' });
  });

  it('shows previews until the load ends, and none of an aborted one', async () => {
    const { cache, loads, dispose } = testCache();
    const renderer = {};
    const asked = requestFor('a.ply', null, renderer);
    const onChange = vi.fn();
    const stop = cache.watch(asked, { onChange });
    const before = cache.stateOf(asked);
    expect(before).toMatchObject({ status: 'pending', data: null });
    for (const preview of ['part', 'larger part']) {
      loads[0].onPreview(preview);
      expect(cache.stateOf(asked)).toEqual({ ...before, data: preview, renderer });
    }
    expect(onChange).toHaveBeenCalledTimes(2);
    const error = new Error('cut off');
    loads[0].reject(error);
    await settle();
    expect(cache.stateOf(asked)).toEqual({ status: 'failed', error });
    stop();
    cache.watch(asked, { onChange })();
    await vi.advanceTimersByTimeAsync(GRACE_MS);
    loads[1].onPreview('late');
    expect(cache.stateOf(asked)).toBeUndefined();
    expect(onChange).toHaveBeenCalledTimes(3);
    // The engine ends them.
    expect(dispose).not.toHaveBeenCalled();
  });

  it('distinguishes files and buffers, but not accuracies', () => {
    const { cache, loads } = testCache();
    const [first, second] = [new Blob(['same']), new Blob(['same'])];
    const buffer = new ArrayBuffer(4);
    const sources = ['https://example.org/a.ply', 'https://example.org/b.ply', first, second, buffer];
    for (const accuracy of ['high', 'balanced'] as const)
      for (const source of sources) cache.watch(requestFor(source, accuracy), {});
    expect(loads.map(({ request: { source, accuracy } }) => [source, accuracy])).toEqual(
      sources.map((source) => [source, 'high']),
    );
  });

  it('aborts a load when its last user has gone, not before, and not if one comes back in time', async () => {
    const { cache, loads } = testCache();
    const stopFirst = cache.watch(request('a.ply'), {});
    const stopSecond = cache.watch(request('a.ply'), {});
    stopFirst();
    await vi.advanceTimersByTimeAsync(2 * GRACE_MS);
    expect(loads[0].signal.aborted).toBe(false);
    stopSecond();
    await vi.advanceTimersByTimeAsync(GRACE_MS - 1);
    const stopThird = cache.watch(request('a.ply'), {});
    await vi.advanceTimersByTimeAsync(2 * GRACE_MS);
    expect(loads[0].signal.aborted).toBe(false);
    stopThird();
    await vi.advanceTimersByTimeAsync(GRACE_MS);
    expect(loads[0].signal.aborted).toBe(true);
    expect(cache.stateOf(request('a.ply'))).toBeUndefined();
    expect(vi.getTimerCount()).toBe(0);
  });

  it('counts a user once, however often it stops', async () => {
    const { cache, loads } = testCache();
    const stop = cache.watch(request('a.ply'), {});
    cache.watch(request('a.ply'), {});
    stop();
    stop();
    await vi.advanceTimersByTimeAsync(2 * GRACE_MS);
    expect(loads[0].signal.aborted).toBe(false);
  });

  it('disposes of loaded data after a grace time', async () => {
    const { cache, loads, dispose } = testCache();
    const stop = cache.watch(request('a.ply'), {});
    loads[0].resolve('a');
    await settle();
    stop();
    await vi.advanceTimersByTimeAsync(GRACE_MS - 1);
    expect(cache.stateOf(request('a.ply'))).toEqual({ status: 'loaded', data: 'a' });
    expect(dispose).not.toHaveBeenCalled();
    await vi.advanceTimersByTimeAsync(1);
    expect(cache.stateOf(request('a.ply'))).toBeUndefined();
    expect(dispose).toHaveBeenCalledExactlyOnceWith('a');
  });

  it('disposes of data that is loaded although its load was aborted, and leaves the next load alone', async () => {
    const { cache, loads, dispose } = testCache();
    cache.watch(request('a.ply'), {})();
    await vi.advanceTimersByTimeAsync(GRACE_MS);
    expect(loads[0].signal.aborted).toBe(true);
    cache.watch(request('a.ply'), {});
    loads[0].resolve('too late');
    await settle();
    expect(dispose).toHaveBeenCalledExactlyOnceWith('too late');
    loads[1].resolve('a');
    await settle();
    expect(cache.stateOf(request('a.ply'))).toEqual({ status: 'loaded', data: 'a' });
    expect(dispose).toHaveBeenCalledTimes(1);
  });

  it('tries again after a failure as soon as the last user has gone', async () => {
    const { cache, loads } = testCache();
    const stop = cache.watch(request('a.ply'), {});
    const error = new Error('no such file');
    loads[0].reject(error);
    await settle();
    expect(cache.stateOf(request('a.ply'))).toEqual({ status: 'failed', error });
    stop();
    cache.watch(request('a.ply'), {});
    expect(loads).toHaveLength(2);
  });

  it('ignores an aborted load, even if a new one has begun', async () => {
    const { cache, loads } = testCache();
    cache.watch(request('a.ply'), {})();
    await vi.advanceTimersByTimeAsync(GRACE_MS);
    const changes = vi.fn();
    cache.watch(request('a.ply'), { onChange: changes });
    loads[0].resolve('late');
    await settle();
    expect(changes).not.toHaveBeenCalled();
    expect(cache.stateOf(request('a.ply'))?.status).toBe('pending');
  });

  it('returns a failure to a render, and tries again some moments later', async () => {
    const { cache, loads } = testCache();
    const state = cache.ask(request('a.ply'));
    const error = new Error('no');
    loads[0].reject(error);
    await expect(state.status === 'pending' && state.settled).resolves.toBeUndefined();
    expect(cache.ask(request('a.ply'))).toEqual({ status: 'failed', error });
    await vi.advanceTimersByTimeAsync(GRACE_MS);
    expect(cache.ask(request('a.ply')).status).toBe('pending');
  });

  it('keeps preloaded entries until they are cleared', async () => {
    const { cache, loads } = testCache();
    cache.preload(request('a.ply'));
    cache.preload(request('b.ply'));
    cache.watch(request('a.ply'), {})();
    await vi.advanceTimersByTimeAsync(2 * UNCLAIMED_GRACE_MS);
    expect(loads.map(({ signal }) => signal.aborted)).toEqual([false, false]);
    cache.clear('a.ply');
    expect(loads.map(({ signal }) => signal.aborted)).toEqual([true, false]);
    cache.clear();
    expect(loads.map(({ signal }) => signal.aborted)).toEqual([true, true]);
  });

  it('keeps entries in use when cleared, and drops them with their last user', async () => {
    const { cache, loads } = testCache();
    cache.preload(request('a.ply'));
    const stop = cache.watch(request('a.ply'), {});
    cache.clear();
    expect(loads[0].signal.aborted).toBe(false);
    stop();
    await vi.advanceTimersByTimeAsync(GRACE_MS);
    expect(loads[0].signal.aborted).toBe(true);
  });

  it('keeps entries that a render has requested until a component has mounted with them, but not for ever', async () => {
    const { cache, loads } = testCache();
    cache.ask(request('a.ply'));
    cache.ask(request('b.ply'));
    await vi.advanceTimersByTimeAsync(UNCLAIMED_GRACE_MS / 2);
    cache.watch(request('a.ply'), {});
    cache.ask(request('a.ply'));
    await vi.advanceTimersByTimeAsync(2 * UNCLAIMED_GRACE_MS);
    expect(loads.map(({ signal }) => signal.aborted)).toEqual([false, true]);
  });
});
