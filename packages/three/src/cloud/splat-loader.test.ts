import {
  DestroyedError,
  encodePly,
  GpuLimitError,
  type SplatCloud,
  SplatFileError,
  type SplatSource,
  SplatSourceError,
} from '@websplatter/core';
import { LoadingManager, Sphere } from 'three/webgpu';
import { afterEach, describe, expect, test, vi } from 'vitest';
import { adoptRenderer, splatEngineOf } from '../renderer/adopt-renderer.ts';
import { fakeEngine } from '../testing/fake-engine.ts';
import { packedCloudAt, splatSetAt } from '../testing/test-clouds.ts';
import type { SplatData } from './splat-data.ts';
import { SplatLoader } from './splat-loader.ts';

vi.mock('../renderer/adopt-renderer.ts');

const file = encodePly(splatSetAt([0, 0, 0], [1, 2, 3])) as Uint8Array<ArrayBuffer>;

/** A manager and its events, in order. */
function watchedManager() {
  const events: string[] = [];
  const manager = new LoadingManager(
    () => events.push('all loaded'),
    (url, loaded, total) => events.push(`${url} ${loaded} of ${total}`),
    (url) => events.push(`${url} failed`),
  );
  manager.onStart = (url) => events.push(`${url} started`);
  return { manager, events };
}

afterEach(() => void vi.unstubAllGlobals());

function stubFetch(respond: (url: string, init?: RequestInit) => Promise<Response>) {
  const fetch = vi.fn((url: string | URL, init?: RequestInit) => respond(String(url), init));
  vi.stubGlobal('fetch', fetch);
  return fetch;
}

describe('a load', () => {
  test('returns splats, and reports to its manager', async () => {
    const { manager, events } = watchedManager();
    const data = await new SplatLoader(manager).loadAsync(new File([file], 'two.ply'));
    expect([data.count, data.name]).toEqual([2, 'two.ply']);
    expect(data.bounds.max.toArray()).toEqual([1, 2, 3]);
    await new Promise((resolve) => setTimeout(resolve, 0));
    expect(events).toEqual(['two.ply started', 'two.ply 1 of 1', 'all loaded']);
  });

  test('by address uses the path and the manager’s URL modifier', async () => {
    const fetch = stubFetch(async () => new Response(file));
    const { manager, events } = watchedManager();
    manager.setURLModifier((url) => `${url}?v=2`);
    const data = await new SplatLoader(manager).setPath('https://a.test/').loadAsync('two.ply');
    expect(data.name).toBe('https://a.test/two.ply?v=2');
    expect(fetch.mock.calls[0][0]).toBe('https://a.test/two.ply?v=2');
    expect(events[0]).toBe('https://a.test/two.ply?v=2 started');
  });

  test('sends the loader’s headers and credentials', async () => {
    const fetch = stubFetch(async () => new Response(file));
    const loader = new SplatLoader().setRequestHeader({ authorization: 'token' }).setWithCredentials(true);
    await loader.loadAsync('https://a.test/two.ply');
    expect(fetch.mock.calls[0][1]).toMatchObject({
      headers: { authorization: 'token' },
      credentials: 'include',
    });
    stubFetch(async () => new Response('', { status: 403 }));
    await expect(loader.loadAsync('https://a.test/two.ply')).rejects.toMatchObject({
      name: 'SplatSourceError',
      status: 403,
    });
  });

  /** @fault Files: neither first bytes nor URL give the format, as for a `.splat` from an API */
  test('takes a format, or a name that tells it, from its options', async () => {
    const splat = new Uint8Array(32).fill(128);
    new Float32Array(splat.buffer, 0, 6).set([1, 2, 3, 0.1, 0.1, 0.1]);
    stubFetch(async () => new Response(splat));
    const loader = new SplatLoader();
    const sources = ['https://a.test/api/17', new Blob([splat]), splat];
    for (const source of sources) {
      loader.sourceOptions = {};
      await expect(loader.loadAsync(source)).rejects.toMatchObject({ code: 'unknown-format' });
      loader.sourceOptions = { format: 'splat' };
      expect((await loader.loadAsync(source)).count).toBe(1);
      loader.sourceOptions = { name: 'shown.splat' };
      const data = await loader.loadAsync(source);
      expect([data.count, data.name]).toEqual([1, 'shown.splat']);
    }
  });

  test('reads no more than its limits allow', async () => {
    const loader = new SplatLoader();
    loader.sourceOptions = { maxSplats: 1 };
    await expect(loader.loadAsync(new Blob([file]))).rejects.toMatchObject({ code: 'too-large' });
    loader.sourceOptions = { maxSplats: 2, maxBytes: file.length - 1 };
    await expect(loader.loadAsync(new Blob([file]))).rejects.toMatchObject({ code: 'too-large' });
  });

  test('reports bytes', async () => {
    const events: ProgressEvent[] = [];
    await new SplatLoader().loadAsync(file, (event) => events.push(event));
    const last = events.at(-1)!;
    expect(last.type).toBe('progress');
    expect([last.lengthComputable, last.loaded, last.total]).toEqual([true, file.length, file.length]);
  });

  /** The contents that an engine is given to upload. */
  function uploadOf(data: SplatData) {
    const { engine, addPacked } = fakeEngine();
    data.acquire(engine, {});
    const [packed, { source } = {}] = addPacked.mock.lastCall!;
    return { packed, source };
  }

  test('packs for the loader’s accuracy', async () => {
    const loader = new SplatLoader();
    const precision = async () =>
      uploadOf(await loader.loadAsync(new Blob([file]))).packed.geometry.precision;
    expect(await precision()).toBe('packed');
    loader.setAccuracy('high');
    expect(await precision()).toBe('f32');
    loader.setAccuracy({ minPsnrDb: 60 });
    expect(await precision()).toBe('packed');
    expect(() => loader.setAccuracy('perfect' as never)).toThrow(/perfect/);
    expect(() => loader.setAccuracy({ minPsnrDb: 60, maxFrameMs: 8 } as never)).toThrow(
      /minPsnrDb: 60, maxFrameMs: 8/,
    );
  });

  test('records the source to read again, and how', async () => {
    stubFetch(async () => new Response(file));
    const sourceOf = async (source: SplatSource, loader = new SplatLoader()) => {
      const upload = uploadOf(await loader.loadAsync(source));
      return upload.source === upload.packed ? 'memory' : upload.source;
    };
    const blob = new Blob([file]);
    expect(await sourceOf(blob)).toBe(blob);
    expect(await sourceOf(new URL('https://a.test/two.ply'))).toBe('https://a.test/two.ply');
    expect(await sourceOf(file)).toBe('memory');
    expect(await sourceOf(blob.stream())).toBe('memory');
    const guarded = new SplatLoader().setWithCredentials(true);
    expect(await sourceOf('https://a.test/two.ply', guarded)).toBe('https://a.test/two.ply');
  });
});

describe('a load for a renderer', () => {
  const { count, origin, chunks, bounds, robustBounds } = packedCloudAt([0, 0, 0], [1, 2, 3]);

  function rendererAndLoader() {
    const fake = fakeEngine({ accuracy: 'high' });
    const cloud = Object.assign(fake.cloud, { count, origin, chunks, bounds, robustBounds });
    fake.load.mockResolvedValue(cloud);
    vi.mocked(adoptRenderer).mockImplementation(async (renderer) => renderer);
    vi.mocked(splatEngineOf).mockReturnValue(fake.engine);
    return { ...fake, loader: new SplatLoader().detectSupport({}) };
  }

  test('goes to its engine, with the renderer’s accuracy unless the loader has another', async () => {
    const { engine, cloud, load, addPacked, loader } = rendererAndLoader();
    const blob = new Blob([file]);
    loader.sourceOptions = { maxSplats: 7, request: { maxRetries: 1 } };
    loader.setRequestHeader({ 'x-key': '1' });
    const data = await loader.loadAsync(blob);
    expect(data.count).toBe(2);
    expect(load.mock.calls[0][1]).toMatchObject({
      maxSplats: 7,
      request: { maxRetries: 1, headers: { 'x-key': '1' }, credentials: 'same-origin' },
    });
    expect(load.mock.calls[0][0]).toBe(blob);
    expect(load.mock.calls[0][1]).toMatchObject({
      name: 'splats',
      precision: { geometryPrecision: 'f32', shPrecision: 'f16' },
    });
    expect(data.acquire(engine, {})).toBe(cloud);
    expect(addPacked).not.toHaveBeenCalled();
    loader.setAccuracy('fast');
    await loader.loadAsync('https://a.test/two.ply');
    loader.setAccuracy({ maxFrameMs: 8 });
    await loader.loadAsync(blob);
    expect(load.mock.lastCall![1]).toMatchObject({
      precision: { geometryPrecision: 'f32', shPrecision: 'f16' },
    });
    loader.setAccuracy('fast');
    await loader.loadAsync('https://a.test/two.ply');
    expect(load.mock.lastCall![0]).toBe('https://a.test/two.ply');
    expect(load.mock.lastCall![1]).toMatchObject({
      precision: { geometryPrecision: 'packed', shPrecision: 'u8' },
    });
  });

  test('streams with its budget, on each renderer, in the only precision there is', async () => {
    const { cloud, load, claim, engine, loader } = rendererAndLoader();
    Object.assign(cloud, { name: 'city', stream: {} });
    loader.budgetBytes = 1e8;
    const data = await loader.loadAsync('https://a.test/city.bricks');
    expect(load.mock.lastCall![1]).toMatchObject({ budgetBytes: 1e8 });
    const next = fakeEngine();
    void data.acquire(next.engine, {});
    await expect.poll(() => next.load.mock.lastCall?.[1]).toMatchObject({ budgetBytes: 1e8 });
    const user = {};
    data.acquire(engine, user);
    data.hold(engine, user, { geometryPrecision: 'packed', shPrecision: 'u8' });
    expect(claim).not.toHaveBeenCalled();
    // Refused by the cloud, so that users are told.
    data.hold(engine, user, { geometryPrecision: 'f32', shPrecision: 'f16' });
    expect(claim).toHaveBeenCalledOnce();
    await expect(data.rowsIn(new Sphere())).rejects.toThrow(/only parts of it are there/);
    data.release(user);
  });

  test('hands out the splats that have arrived, until it is aborted', async () => {
    const { engine, cloud, load, loader } = rendererAndLoader();
    const blob = new Blob([file]);
    await loader.loadAsync(blob);
    expect(load.mock.lastCall![1]!.onPreview).toBeUndefined();
    const onPreview = vi.fn<(preview: SplatData) => void>();
    loader.onPreview = onPreview;
    let arrive = () => {};
    load.mockImplementation(async (_source, options) => {
      arrive = () => options!.onPreview!({ ...cloud, isPreview: true, count: 1 } as SplatCloud);
      arrive();
      arrive();
      return cloud;
    });
    const data = await loader.loadAsync(blob);
    const [first, second] = onPreview.mock.calls.map(([preview]) => preview);
    expect(first).toMatchObject({ isPreview: true, count: 1, name: 'splats' });
    expect(second).not.toBe(first);
    expect(first.acquire(engine, {})).toMatchObject({ isPreview: true });
    expect(data).toMatchObject({ isPreview: false, count: 2 });
    loader.abort();
    arrive();
    expect(onPreview).toHaveBeenCalledTimes(2);
  });

  test('reads sources that can be read only once into memory', async () => {
    const { load, loader } = rendererAndLoader();
    for (const source of [file, new Blob([file]).stream()]) await loader.loadAsync(source);
    expect(load).not.toHaveBeenCalled();
  });

  /**
   * @fault Devices and engines: a load in three.js outlives its renderer
   * @consequence the next renderer gets the splats
   */
  test('goes on in memory for the next renderer where this one ends', async () => {
    const { load, loader } = rendererAndLoader();
    load.mockRejectedValue(new DestroyedError('This engine', 'the device was lost'));
    const data = await loader.loadAsync(new Blob([file]));
    const next = fakeEngine();
    data.acquire(next.engine, {});
    expect(next.addPacked).toHaveBeenCalledTimes(1);
  });

  test('fails with the engine, and ends with the loader', async () => {
    const { load, loader } = rendererAndLoader();
    const tooLarge = new GpuLimitError('memory', 2, 1, 'garden does not fit');
    load.mockRejectedValueOnce(tooLarge);
    await expect(loader.loadAsync(new Blob([file]))).rejects.toBe(tooLarge);
    load.mockReset();
    const loading = loader.loadAsync(new Blob([file]));
    loader.abort();
    await expect(loading).rejects.toMatchObject({ name: 'AbortError' });
  });
});

describe('a load that fails', () => {
  test.each([
    ['because of the file', async () => new Response('no splats'), SplatFileError],
    ['because of the server', async () => new Response('', { status: 404 }), SplatSourceError],
  ])('%s rejects and is reported to the manager', async (_, respond, type) => {
    stubFetch(respond);
    const { manager, events } = watchedManager();
    const load = new SplatLoader(manager).loadAsync('https://a.test/x.ply');
    await expect(load).rejects.toBeInstanceOf(type);
    await new Promise((resolve) => setTimeout(resolve, 0));
    expect(events).toEqual([
      'https://a.test/x.ply started',
      'https://a.test/x.ply failed',
      'https://a.test/x.ply 1 of 1',
      'all loaded',
    ]);
  });

  test('is logged without a listener', async () => {
    const log = vi.spyOn(console, 'error').mockImplementation(() => {});
    new SplatLoader(new LoadingManager()).load(new Blob(['no splats']), () => {});
    await expect.poll(() => log).toHaveBeenCalledWith(expect.any(SplatFileError));
    log.mockRestore();
  });
});

describe('abort', () => {
  /** A server that never answers. */
  function silence() {
    return stubFetch(
      (_, init) =>
        new Promise((_resolve, reject) => {
          init?.signal?.addEventListener('abort', () => reject(init.signal?.reason));
        }),
    );
  }

  test.each(['loader', 'manager'] as const)('of the %s ends its loads', async (owner) => {
    const fetch = silence();
    const { manager, events } = watchedManager();
    const loader = new SplatLoader(manager);
    const load = loader.loadAsync('https://a.test/x.ply');
    const outcome = expect(load).rejects.toMatchObject({ name: 'AbortError' });
    await expect.poll(() => fetch).toHaveBeenCalled();
    (owner === 'loader' ? loader : manager).abort();
    await outcome;
    await new Promise((resolve) => setTimeout(resolve, 0));
    expect(events).toContain('https://a.test/x.ply failed');
  });

  test('does not affect later loads', async () => {
    const loader = new SplatLoader();
    loader.abort();
    expect((await loader.loadAsync(new Blob([file]))).count).toBe(2);
  });
});
