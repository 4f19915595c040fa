import { createRoot } from '@react-three/fiber';
import { InvalidArgumentError, type SplatEngine } from '@websplatter/core';
import { makeColliderMesh } from '@websplatter/core/collider';
import { adoptRenderer, findSplatEngine, onStageTimings, type SplatData } from '@websplatter/three';
import { act, createElement, type ReactNode } from 'react';
import { renderToString } from 'react-dom/server';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import {
  type SplatsLoad,
  useSplatAccuracy,
  useSplatCollider,
  useSplatEffects,
  useSplatMemory,
  useSplatStreams,
  useSplatsLoad,
  useStageTimings,
} from './hooks.ts';
import { GRACE_MS } from './splat-cache.ts';

interface Load {
  readonly source: unknown;
  readonly renderer: unknown;
  readonly isAborted: () => boolean;
  readonly onProgress: (progress: Partial<ProgressEvent>) => void;
  readonly resolve: (data: SplatData) => void;
  readonly reject: (error: Error) => void;
}

const test = vi.hoisted(() => ({ loads: [] as Load[], measured: new Set<(statistics: object) => void>() }));

// Loading and drawing are tested with three; here tests say when files are read, frames measured.
vi.mock('@websplatter/three', () => ({
  onStageTimings: vi.fn((_renderer: object, listener: (statistics: object) => void) => {
    test.measured.add(listener);
    return () => test.measured.delete(listener);
  }),
  SplatCloudObject: class {},
  adoptRenderer: vi.fn(),
  findSplatEngine: vi.fn(),
  SplatLoader: class {
    #renderer: unknown;
    #isAborted = false;
    detectSupport(renderer: unknown) {
      this.#renderer = renderer;
    }
    abort() {
      this.#isAborted = true;
    }
    loadAsync(source: unknown, onProgress: (progress: object) => void) {
      const isAborted = () => this.#isAborted;
      return new Promise<SplatData>((resolve, reject) => {
        test.loads.push({ source, renderer: this.#renderer, isAborted, onProgress, resolve, reject });
      });
    }
  },
}));

vi.mock('@websplatter/core/collider', () => ({ makeColliderMesh: vi.fn() }));

const renderer = { render() {}, setPixelRatio() {}, setSize() {}, dispose() {} };
/** State of the engine, which a test changes. */
const engine = {
  memory: { totalBytes: 1 },
  effects: [] as object[],
  accuracy: { rasterizer: 'quads' },
  clouds: [] as object[],
};

let root: ReturnType<typeof createRoot>;

beforeEach(async () => {
  vi.useFakeTimers();
  vi.stubGlobal('IS_REACT_ACT_ENVIRONMENT', true);
  vi.stubGlobal('document', { baseURI: 'https://example.org/' });
  Object.assign(engine, {
    memory: { totalBytes: 1 },
    effects: [],
    accuracy: { rasterizer: 'quads' },
    clouds: [],
  });
  const found = {
    memory: () => ({ ...engine.memory }),
    effects: () => [...engine.effects],
    drawnAccuracy: () => ({ ...engine.accuracy }),
    get clouds() {
      return [...engine.clouds];
    },
  };
  vi.mocked(findSplatEngine).mockReturnValue(found as unknown as SplatEngine);
  vi.mocked(onStageTimings).mockClear();
  test.loads.length = 0;
  // three logs that it is imported twice.
  vi.spyOn(console, 'warn').mockImplementation(() => {});
  const canvas = { addEventListener() {}, removeEventListener() {} } as unknown as HTMLCanvasElement;
  root = createRoot(canvas);
  const size = { width: 96, height: 64, top: 0, left: 0 };
  await root.configure({ gl: renderer as never, frameloop: 'never', size, dpr: 1 });
});

afterEach(async () => {
  await act(async () => root.unmount());
  await vi.advanceTimersByTimeAsync(2 * GRACE_MS);
  expect(vi.getTimerCount(), 'timers left').toBe(0);
  expect(test.measured.size, 'listeners left').toBe(0);
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
  vi.useRealTimers();
});

/** Renders the component of the last `rendersOf` again. */
let again = async () => {};

/** Renders a component that calls `use`, in a Canvas; returns its results, render by render. */
async function rendersOf<Result>(use: () => Result): Promise<Result[]> {
  const results: Result[] = [];
  function Caller(): ReactNode {
    results.push(use());
    return null;
  }
  again = () =>
    act(async () => {
      root.render(createElement(Caller));
    });
  await again();
  return results;
}

async function measureFrames(count: number): Promise<void> {
  await act(async () => {
    for (let i = 0; i < count; i++) for (const listener of [...test.measured]) listener({ frame: i });
    await vi.advanceTimersByTimeAsync(250);
  });
}

describe('useSplatStreams', () => {
  /** A stream whose report a test changes. */
  function fakeStream(report: object) {
    const listeners = new Set<() => void>();
    const subscribe = (listener: () => void) => {
      listeners.add(listener);
      return () => listeners.delete(listener);
    };
    const state = { report };
    const change = (changed: object) => {
      state.report = changed;
      for (const listener of [...listeners]) listener();
    };
    return { stream: { report: () => state.report, subscribe, retry: vi.fn() }, state, change, listeners };
  }

  it('renders again after a change without a frame, and while parts are fetched', async () => {
    const { stream, state, change, listeners } = fakeStream({ missingBricks: 0, fetching: 0 });
    const renders = await rendersOf(() => useSplatStreams());
    expect(renders.at(-1)).toEqual([]);
    engine.clouds = [
      { name: 'whole', stream: null },
      { name: 'city', stream },
    ];
    await measureFrames(1);
    expect(renders.at(-1)).toEqual([{ name: 'city', stream, missingBricks: 0, fetching: 0 }]);
    const before = renders.length;
    const later = () => act(async () => void (await vi.advanceTimersByTimeAsync(250)));
    await later();
    expect(renders).toHaveLength(before);
    for (let i = 0; i < 3; i++) change({ missingBricks: 3, fetching: 2, bytesPerSecond: 7 });
    await later();
    expect(renders).toHaveLength(before + 1);
    state.report = { missingBricks: 3, fetching: 2, bytesPerSecond: 5 };
    await later();
    expect(renders.at(-1)).toMatchObject([{ bytesPerSecond: 5 }]);
    const error = new Error('the server is gone');
    change({ missingBricks: 3, fetching: 0, error });
    await later();
    expect(renders.at(-1)![0].error).toBe(error);
    const { length } = renders;
    await later();
    expect(renders).toHaveLength(length);
    renders.at(-1)![0].stream.retry();
    expect(stream.retry).toHaveBeenCalledOnce();
    await act(async () => root.render(null));
    expect(listeners.size).toBe(0);
  });
});

describe.each([
  ['useSplatMemory', useSplatMemory, 'memory', { totalBytes: 2 }],
  ['useSplatEffects', useSplatEffects, 'effects', [{ name: 'tint' }]],
  ['useSplatAccuracy', useSplatAccuracy, 'accuracy', { rasterizer: 'tiles' }],
])('%s', (name, anyUse, changed, value) => {
  const use = anyUse as (...given: unknown[]) => unknown;

  it('renders again some time after frames, if something has changed', async () => {
    const renders = await rendersOf(() => use());
    expect(renders).toHaveLength(2);
    expect(renders[0]).toBeNull();
    await measureFrames(3);
    expect(renders).toHaveLength(2);
    Object.assign(engine, { [changed]: value });
    await measureFrames(3);
    expect(renders).toHaveLength(3);
    expect(renders[2]).toEqual(value);
  });

  it('renders for changes of what is selected, and of the selection', async () => {
    let isOther = false;
    const select = vi.fn((found: object) => (isOther ? found : 'name' in found));
    const renders = await rendersOf(() => use(select));
    const { length } = renders;
    expect(renders[length - 1]).toBe(false);
    Object.assign(engine, { [changed]: value });
    await measureFrames(3);
    expect(renders).toHaveLength(length);
    isOther = true;
    await again();
    expect(renders.at(-1)).toEqual(value);
    expect(select).not.toHaveBeenCalledWith(null);
  });

  it('takes a renderer outside of a Canvas, and asks for one', async () => {
    const other = {};
    const Caller = ({ given }: { given: unknown[] }) => String(use(...given));
    const shown = (...given: unknown[]) => renderToString(createElement(Caller, { given }));
    for (const given of [[], [() => 1]]) {
      expect(() => shown(...given)).toThrow(InvalidArgumentError);
      expect(() => shown(...given)).toThrow(`Outside of a Canvas, ${name} needs`);
    }
    expect(shown(other)).toBe('null');
    expect(findSplatEngine).toHaveBeenLastCalledWith(other);
    expect(shown(() => 1, other)).toBe('null');
    expect(findSplatEngine).toHaveBeenLastCalledWith(other);
  });

  it('is empty outside of a Canvas whose renderer is not there yet', () => {
    vi.mocked(findSplatEngine).mockClear();
    const Caller = ({ given }: { given: unknown[] }) => String(use(...given));
    for (const given of [[null], [undefined], [() => 1, null], [() => 1, undefined]])
      expect(renderToString(createElement(Caller, { given }))).toBe('null');
    expect(findSplatEngine).not.toHaveBeenCalled();
  });
});

it('hooks wait for the engine of a renderer that others made, and fail with it', async () => {
  const found = vi.mocked(findSplatEngine).getMockImplementation()!;
  let arrive = () => {};
  vi.mocked(findSplatEngine).mockReturnValue(null);
  vi.mocked(adoptRenderer).mockImplementation(
    () => new Promise((_, reject) => (arrive = () => reject(new Error('or fails')))),
  );
  const renders = await rendersOf(() => useSplatMemory());
  expect(renders).toEqual([null]);
  vi.mocked(findSplatEngine).mockImplementation(found);
  await act(async () => arrive());
  expect(renders.at(-1)).toEqual({ totalBytes: 1 });
  const failure = new Error('no engine');
  vi.mocked(findSplatEngine).mockImplementation(() => {
    throw failure;
  });
  const Caller = () => String(useSplatMemory(renderer));
  expect(() => renderToString(createElement(Caller))).toThrow(failure);
});

it('useSplatMemory is read again without a frame', async () => {
  const renders = await rendersOf(() => useSplatMemory());
  Object.assign(engine, { memory: { totalBytes: 0 } });
  await act(async () => void (await vi.advanceTimersByTimeAsync(250)));
  expect(renders.at(-1)).toEqual({ totalBytes: 0 });
  await act(async () => root.render(null));
  expect(vi.getTimerCount()).toBe(0);
});

it('useStageTimings is empty outside of a Canvas whose renderer is not there yet', () => {
  const Caller = ({ given }: { given: [] | [object | null | undefined] }) =>
    String(useStageTimings(undefined, ...given).current);
  for (const renderer of [null, undefined])
    expect(renderToString(createElement(Caller, { given: [renderer] }))).toBe('null');
  expect(() => renderToString(createElement(Caller, { given: [] }))).toThrow('useStageTimings needs');
});

it('useStageTimings passes each measured frame on, and causes no render', async () => {
  const listener = vi.fn();
  const renders = await rendersOf(() => useStageTimings(listener));
  expect(renders[0].current).toBeNull();
  await measureFrames(2);
  expect(listener.mock.calls).toEqual([[{ frame: 0 }], [{ frame: 1 }]]);
  expect(renders[0].current).toEqual({ frame: 1 });
  expect(renders).toHaveLength(1);
});

describe('useSplatsLoad', () => {
  const data = { name: 'a', dispose() {} } as SplatData;

  it('tells how far a file has been read, without suspending', async () => {
    const renders = await rendersOf(() => useSplatsLoad('a.ply'));
    const pending: SplatsLoad = {
      status: 'pending',
      splats: null,
      error: undefined,
      loadedBytes: 0,
      totalBytes: null,
    };
    expect(renders.at(-1)).toEqual(pending);
    expect(test.loads).toMatchObject([{ source: 'a.ply', renderer }]);
    await act(async () => test.loads[0].onProgress({ loaded: 1, total: 0, lengthComputable: false }));
    expect(renders.at(-1)).toEqual({ ...pending, loadedBytes: 1 });
    await act(async () => test.loads[0].onProgress({ loaded: 3, total: 4, lengthComputable: true }));
    expect(renders.at(-1)).toEqual({ ...pending, loadedBytes: 3, totalBytes: 4 });
    await act(async () => test.loads[0].resolve(data));
    const loaded = { ...pending, status: 'loaded', splats: data, loadedBytes: 3, totalBytes: 4 };
    expect(renders.at(-1)).toEqual(loaded);
    // A file that was read before is there at once.
    const others = await rendersOf(() => useSplatsLoad('a.ply'));
    expect(others.at(-1)).toMatchObject({ status: 'loaded', splats: data });
    expect(test.loads).toHaveLength(1);
  });

  it('returns the error of a load that has failed', async () => {
    const renders = await rendersOf(() => useSplatsLoad('b.ply'));
    const error = new Error('no such file');
    await act(async () => test.loads[0].reject(error));
    expect(renders.at(-1)).toMatchObject({ status: 'failed', error, splats: null });
  });

  it('aborts a load that is not wanted any more', async () => {
    await rendersOf(() => useSplatsLoad('c.ply'));
    await act(async () => root.render(null));
    await vi.advanceTimersByTimeAsync(GRACE_MS);
    expect(test.loads[0].isAborted()).toBe(true);
  });

  it.each([undefined, null, ''])('reads nothing where there is no source: %j', async (source) => {
    expect(await rendersOf(() => useSplatsLoad(source))).toMatchObject([{ status: 'none', splats: null }]);
    expect(test.loads).toHaveLength(0);
  });

  it('leaves reading to the browser', () => {
    Reflect.deleteProperty(globalThis, 'document');
    const Caller = () => useSplatsLoad('d.ply').status;
    expect(renderToString(createElement(Caller))).toBe('none');
    expect(test.loads).toHaveLength(0);
  });
});

describe('useSplatCollider', () => {
  const cloud = {};
  const mesh = { positions: new Float32Array(3), indices: new Uint32Array(3), cellSize: 1 };
  const splats = () => ({ acquire: vi.fn(() => cloud), release: vi.fn() });
  const asData = (fake: ReturnType<typeof splats>) => fake as unknown as SplatData;

  /** Lets the hook fetch its code, and act on it. */
  const settled = () =>
    act(async () => {
      await vi.dynamicImportSettled();
    });

  beforeEach(() => {
    vi.mocked(makeColliderMesh).mockReset();
  });

  it('makes a mesh of the cloud on the GPU, once for equal options, and lets the cloud go', async () => {
    vi.mocked(makeColliderMesh).mockResolvedValue(mesh);
    const data = splats();
    const renders = await rendersOf(() => useSplatCollider(asData(data), { cellSize: 0.5 }));
    await settled();
    expect(renders.at(-1)).toEqual({ status: 'made', mesh, error: undefined });
    expect(renders[0]).toEqual({ status: 'pending', mesh: null, error: undefined });
    expect(vi.mocked(makeColliderMesh).mock.calls).toEqual([
      [cloud, { cellSize: 0.5, signal: expect.any(AbortSignal) }],
    ]);
    expect(data.release).toHaveBeenCalledOnce();
  });

  it('returns the error of a mesh that cannot be made', async () => {
    const error = new InvalidArgumentError('cellSize', 'too small');
    vi.mocked(makeColliderMesh).mockRejectedValue(error);
    const data = asData(splats());
    const renders = await rendersOf(() => useSplatCollider(data));
    await settled();
    expect(renders.at(-1)).toEqual({ status: 'failed', mesh: null, error });
  });

  it('calls off loads that are not awaited any more', async () => {
    vi.mocked(makeColliderMesh).mockReturnValue(new Promise(() => {}));
    const data = asData(splats());
    await rendersOf(() => useSplatCollider(data));
    await settled();
    const { signal } = vi.mocked(makeColliderMesh).mock.lastCall![1]!;
    await act(async () => root.render(null));
    expect(signal!.aborted).toBe(true);
  });

  it('makes none without splats, and needs a Canvas', async () => {
    expect(await rendersOf(() => useSplatCollider(null))).toMatchObject([{ status: 'none', mesh: null }]);
    expect(makeColliderMesh).not.toHaveBeenCalled();
    const Caller = () => useSplatCollider(null).status;
    expect(() => renderToString(createElement(Caller))).toThrow('needs a Canvas');
    Reflect.deleteProperty(globalThis, 'document');
    expect(renderToString(createElement(Caller))).toBe('none');
  });
});
