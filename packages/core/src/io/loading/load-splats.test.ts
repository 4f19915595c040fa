import { MessageChannel, type MessagePort } from 'node:worker_threads';
import { gzipSync } from 'node:zlib';
import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import {
  InvalidArgumentError,
  SplatFileError,
  SplatSourceError,
  WebSplatterError,
} from '../../data/errors.ts';
import type { RowLayout } from '../../data/packing/row-layout.ts';
import { type AnyJson, glbBytes, gltfOf, splatAttributes } from '../../testing/gltf-fixture.ts';
import { meshoptPacked } from '../../testing/meshopt-fixture.ts';
import { chunked, plyBytes, splatElement } from '../../testing/ply-fixture.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { reportedErrors } from '../../testing/reported-errors.ts';
import { PLY_READERS } from '../formats/ply/read-ply.ts';
import { encodePly } from '../formats/ply/write-ply.ts';
import type { FormatReaders } from '../formats/read-format.ts';
import { ALL_READERS } from '../formats/readers.ts';
import type { RowSink } from '../formats/rows/row-sink.ts';
import { fromPostedError, toPostedError } from '../posted-error.ts';
import { knownSource, lastingSource } from '../sources/known-source.ts';
import type { LoadProgress, SplatSource } from '../sources/splat-source.ts';
import { loadOrPass, loadSplats } from './load-splats.ts';
import { type LoadPort, type LoadRequest, serveLoad, withPageDecoder } from './serve-load.ts';
import { setWorkerUrl } from './start-worker.ts';

const ply = plyBytes({ format: 'binary_little_endian', elements: [splatElement(300, 1)] });

/** The formats that each worker reads, by the beginning of its name. */
const READERS: Readonly<Record<string, FormatReaders>> = {
  ply: PLY_READERS,
  formats: ALL_READERS,
  load: ALL_READERS,
};

type Behaviour = 'works' | 'throws' | 'does not start' | 'never starts' | 'dies' | 'takes no streams';

const packed = gzipSync(ply);

const FILES = { minRows: 1, maxRows: 1000, pieceBytes: 20_000 };

/** Keeps the rows that it is given; all pieces are written to the same memory. */
class RowList implements RowSink {
  readonly mayDetach = false;
  layout: RowLayout | null = null;
  readonly rows: Uint8Array[] = [];
  readonly notes: string[] = [];
  memories = 0;
  #memory = new Uint8Array(0);

  async begin(layout: RowLayout): Promise<void> {
    this.layout = layout;
    this.#memory = new Uint8Array(Math.min(layout.count, layout.pieceRows) * layout.strideBytes);
    this.memories++;
  }

  async memory(): Promise<Uint8Array<ArrayBuffer>> {
    return this.#memory;
  }

  take(rowCount: number): void {
    this.rows.push(this.#memory.slice(0, rowCount * this.layout!.strideBytes));
  }

  note(text: string): void {
    this.notes.push(text);
  }
}

/** A worker in this thread behind a real message channel, which clones or transfers as usual. */
class FakeWorker {
  static behaviour: Behaviour = 'works';
  static started: FakeWorker[] = [];
  static requests: LoadRequest[] = [];
  onmessage: ((event: MessageEvent) => void) | null = null;
  onerror: ((event: Partial<ErrorEvent>) => void) | null = null;
  onmessageerror: (() => void) | null = null;
  isTerminated = false;
  /** Beginning of the worker's name. */
  readonly kind: string;
  readonly #page: MessagePort;
  readonly #inside: MessagePort;

  constructor(url: URL | string, options: WorkerOptions) {
    this.kind = /([a-z-]+)-worker[^/]*$/.exec(String(url))![1];
    expect(options.type).toBe('module');
    if (FakeWorker.behaviour === 'throws') throw new DOMException('not allowed here', 'SecurityError');
    FakeWorker.started.push(this);
    const { port1, port2 } = new MessageChannel();
    this.#page = port1;
    this.#inside = port2;
    port1.on('message', (data) => this.onmessage?.({ data } as MessageEvent));
    if (FakeWorker.behaviour === 'does not start') setTimeout(() => this.onerror?.({ preventDefault() {} }));
    else if (FakeWorker.behaviour !== 'never starts') this.#serve(port2);
  }

  postMessage(request: LoadRequest, transfer: Transferable[]): void {
    const isStream = request.kind === 'load' && request.source.kind === 'stream';
    if (FakeWorker.behaviour === 'takes no streams' && isStream) {
      throw new DOMException('cannot be cloned', 'DataCloneError');
    }
    FakeWorker.requests.push(request);
    if (FakeWorker.behaviour === 'dies') setTimeout(() => this.onerror?.({ message: 'out of memory' }));
    else this.#page.postMessage(request, transfer as never);
  }

  terminate(): void {
    this.isTerminated = true;
    this.#page.close();
  }

  #serve(inside: MessagePort): void {
    const port: LoadPort = {
      onmessage: null,
      postMessage: (reply, transfer) => this.#inside.postMessage(reply, transfer as never),
    };
    inside.on('message', (data) => port.onmessage?.({ data } as MessageEvent<LoadRequest>));
    serveLoad(port, this.kind === 'ply' ? READERS.ply : withPageDecoder(port, READERS[this.kind]));
  }
}

function useWorkers(behaviour: Behaviour): void {
  FakeWorker.behaviour = behaviour;
  FakeWorker.started = [];
  FakeWorker.requests = [];
  vi.stubGlobal('Worker', FakeWorker);
}

beforeEach(() => {
  vi.spyOn(console, 'warn').mockImplementation(() => {});
});

afterEach(() => {
  setWorkerUrl(null);
  vi.restoreAllMocks();
  for (const worker of FakeWorker.started) expect(worker.isTerminated).toBe(true);
  FakeWorker.started = [];
  vi.unstubAllGlobals();
});

const failure = async (promise: Promise<unknown>): Promise<Error> =>
  promise.then(
    () => expect.fail('should have been rejected'),
    (reason) => reason,
  );

const sources: { name: string; make: () => SplatSource }[] = [
  { name: 'ArrayBuffer', make: () => ply.buffer },
  { name: 'view', make: () => new Uint8Array([0, 0, ...ply]).subarray(2) },
  { name: 'Blob', make: () => new Blob([ply]) },
  { name: 'stream', make: () => chunked(ply, [1000]) },
  { name: 'data URL', make: () => `data:;base64,${Buffer.from(ply).toString('base64')}` },
];

describe.each<Behaviour>(['works', 'throws', 'does not start', 'takes no streams'])(
  'a worker that %s',
  (behaviour) => {
    test.each(sources)('$name', async ({ make }) => {
      const here = await loadSplats(make());
      useWorkers(behaviour);
      const reports: LoadProgress[] = [];
      const cloud = await loadSplats(make(), { onProgress: (progress) => reports.push(progress) });
      expect(cloud).toEqual(here);
      expect(cloud.count).toBe(300);
      expect(reports.map(({ phase }) => phase)).toContain('read');
      expect(reports.at(-1)).toMatchObject({ phase: 'arrange', loadedBytes: ply.length, splats: 300 });
      // The caller's memory is still the caller's.
      expect(ply.length).toBeGreaterThan(0);
    });

    test('rows are handed on as they are, in order, and their memory is used again', async () => {
      useWorkers(behaviour);
      const sink = new RowList();
      expect(await loadOrPass(knownSource(new Blob([ply])), {}, { sink, files: FILES })).toBe('passed');
      const { layout, rows, memories } = sink;
      expect(layout).toMatchObject({ count: 300, strideBytes: 92, pieceRows: 256, isBigEndian: false });
      expect(Buffer.concat(rows).equals(ply.subarray(ply.length - 300 * 92))).toBe(true);
      expect(rows.map((piece) => piece.length / 92)).toEqual([256, 44]);
      expect(memories).toBe(1);
    });

    test.each([
      ['handed on as they come where they are slow', 300, true],
      ['read here where they are there soon', 0, false],
    ])('few rows of a server’s are %s', async (_, chunkMs, isPassed) => {
      useWorkers(behaviour);
      let nowMs = 0;
      vi.spyOn(performance, 'now').mockImplementation(() => nowMs);
      let at = 0;
      const body = new ReadableStream<Uint8Array>({
        pull(controller) {
          nowMs += chunkMs;
          controller.enqueue(ply.slice(at, at + 4000));
          at += 4000;
          if (at >= ply.length) controller.close();
        },
      });
      const headers = { 'content-length': String(ply.length) };
      vi.stubGlobal('fetch', async () => new Response(body, { headers }));
      const sink = new RowList();
      const files = { ...FILES, minRows: 301 };
      const result = await loadOrPass(knownSource('https://example.com/few.ply'), {}, { sink, files });
      expect(result === 'passed').toBe(isPassed);
      const rows = isPassed ? ply.subarray(ply.length - 300 * 92) : new Uint8Array();
      expect(Buffer.concat(sink.rows).equals(rows)).toBe(true);
    });

    test('rows are read here where the sink takes no such files, or the size is not known', async () => {
      useWorkers(behaviour);
      const sink = new RowList();
      for (const files of [
        { ...FILES, minRows: 301 },
        { ...FILES, maxRows: 299 },
      ])
        expect(await loadOrPass(knownSource(new Blob([ply])), {}, { sink, files })).toMatchObject({
          count: 300,
        });
      const stream = chunked(ply, [1000]);
      expect(await loadOrPass(knownSource(stream), {}, { sink, files: FILES })).toMatchObject({ count: 300 });
      const text = plyBytes({ format: 'ascii', elements: [splatElement(300, 1)] });
      expect(await loadOrPass(knownSource(new Blob([text])), {}, { sink, files: FILES })).toMatchObject({
        count: 300,
      });
      expect(sink.layout).toBeNull();
    });

    test('an error of the sink ends the load', async () => {
      useWorkers(behaviour);
      const reason = new Error('no memory');
      const sink = new RowList();
      sink.begin = () => Promise.reject(reason);
      expect(await failure(loadOrPass(knownSource(new Blob([ply])), {}, { sink, files: FILES }))).toBe(
        reason,
      );
    });

    /**
     * @fault Files: the name of a file gives another format
     * @consequence the worker of all formats reads it
     */
    test.each([
      { name: 'Blob', make: () => new Blob([packed]), kinds: ['ply', 'formats'] },
      { name: 'named File', make: () => new File([packed], 'A.PLY.GZ'), kinds: ['formats'] },
      { name: 'misnamed File', make: () => new File([ply], 'a.gz'), kinds: ['formats'] },
      { name: 'list of one', make: () => ({ files: [new File([packed], 'a.gz')] }), kinds: ['formats'] },
      { name: 'stream', make: () => chunked(packed, [700]), kinds: ['ply', 'formats'] },
    ])('$name of another format', async ({ name, make, kinds }) => {
      const here = await loadSplats(make());
      useWorkers(behaviour);
      const reports: LoadProgress[] = [];
      const cloud = await loadSplats(make(), { onProgress: (progress) => reports.push(progress) });
      expect(cloud).toEqual(here);
      expect(cloud.facts.fileFacts?.format).toBe('ply');
      expect(reports.at(-1)).toMatchObject({ phase: 'arrange', splats: 300 });
      if (behaviour === 'works') expect(FakeWorker.started.map(({ kind }) => kind)).toEqual(kinds);
      // A Blob that was given back is posted again.
      if (behaviour === 'works' && name === 'Blob') expect(FakeWorker.requests).toHaveLength(2);
    });

    test('a file of no known format', async () => {
      useWorkers(behaviour);
      for (const make of [() => new Blob(['plywood']), () => chunked(Buffer.from('plywood'), [3])]) {
        const error = await failure(loadSplats(make(), { name: 'shed' }));
        expect(error).toMatchObject({ code: 'unknown-format', file: 'shed' });
      }
    });

    test('settings cross', async () => {
      useWorkers(behaviour);
      const { harmonics } = await loadSplats(ply, { shPrecision: 'f16', geometryPrecision: 'f32' });
      expect(harmonics.precision).toBe('f16');
    });

    test('needs of the splats cross, and invisible bands do not', async () => {
      const set = randomSplats({ count: 50 });
      set.harmonics.coefficients.fill(0);
      const source = encodePly(set);
      const here = await loadSplats(source);
      useWorkers(behaviour);
      const { facts, harmonics } = await loadSplats(source);
      expect(facts).toMatchObject({ declaredShDegree: 3, trueShDegree: 0, shBandReach: [0, 0, 0] });
      expect(facts).toEqual(here.facts);
      expect(harmonics).toMatchObject({ degree: 0, words: new Uint32Array() });
    });

    test('options that cannot cross are taken here, or refused', async () => {
      useWorkers(behaviour);
      // In browsers, Headers are such.
      const headers = Object.assign([['x-key', '1']], { cannotCross: () => {} });
      for (const { name, make } of sources) {
        const cloud = await loadSplats(make(), { request: { headers: headers as never } });
        expect(cloud.count, name).toBe(300);
      }
      expect(await failure(loadSplats(ply, { name: Symbol('s') as never }))).toBeInstanceOf(
        InvalidArgumentError,
      );
    });

    test('typed errors cross', async () => {
      useWorkers(behaviour);
      const error = await failure(loadSplats(ply.slice(0, ply.length - 5), { name: 'cut.ply' }));
      expect(error).toBeInstanceOf(SplatFileError);
      expect(error).toMatchObject({ code: 'truncated', file: 'cut.ply', place: { element: 'vertex' } });
      expect(error.message).toMatch(/^cut\.ply: 300 splats need .* \(element vertex, byte \d+\)$/);
      const wrong = await failure(loadSplats({} as unknown as SplatSource));
      expect(wrong).toBeInstanceOf(InvalidArgumentError);
      const locked = chunked(ply, [10]);
      locked.getReader();
      expect(await failure(loadSplats(locked))).toBeInstanceOf(SplatSourceError);
    });
  },
);

describe('a worker that the page hosts', () => {
  test.each<[string, SplatSource]>([
    ['PLY', new Blob([ply])],
    ['another format', new Blob([packed])],
    ['another format by its name', new File([packed], 'a.ply.gz')],
    ['a list of files', { files: [new File([packed], 'a.ply.gz')] }],
  ])('reads %s at the first attempt', async (_, source) => {
    const here = await loadSplats(source);
    useWorkers('works');
    setWorkerUrl('https://example.org/load-worker.js');
    expect(await loadSplats(source)).toEqual(here);
    expect(FakeWorker.started.map(({ kind }) => kind)).toEqual(['load']);
  });

  test('is forgotten by null', async () => {
    useWorkers('works');
    setWorkerUrl('https://example.org/load-worker.js');
    setWorkerUrl(null);
    await loadSplats(ply);
    expect(FakeWorker.started.map(({ kind }) => kind)).toEqual(['ply']);
  });
});

test('URLs are resolved against the page, not the worker, and keep the name that was given', async () => {
  useWorkers('works');
  vi.stubGlobal('document', { baseURI: 'http://127.0.0.1:1/app/page.html' });
  const error = await failure(loadSplats('scenes/garden.ply'));
  expect(FakeWorker.requests[0]).toMatchObject({
    source: { url: 'http://127.0.0.1:1/app/scenes/garden.ply' },
  });
  expect(error).toBeInstanceOf(SplatSourceError);
  expect(error).toMatchObject({ file: 'scenes/garden.ply' });
});

test.each([
  { options: { format: 'splat' }, source: new Blob([ply]), kinds: ['formats'] },
  { options: { format: 'ply' }, source: new File([ply], 'a.splat'), kinds: ['ply'] },
  { options: { name: 'a.splat' }, source: new Blob([ply]), kinds: ['formats'] },
  { options: { name: 'Room No.5' }, source: new File([ply], 'a.ply'), kinds: ['ply'] },
  { options: { name: 'a.ply' }, source: new Blob([packed]), kinds: ['ply', 'formats'] },
] as const)('$options chooses the worker that starts', async ({ options, source, kinds }) => {
  useWorkers('works');
  expect(await loadSplats(source, options)).toMatchObject({ count: 300 });
  expect(FakeWorker.started.map(({ kind }) => kind)).toEqual(kinds);
});

test.each(['obj', '', 'a b'])('the format “%s” is refused', async (format) => {
  useWorkers('works');
  const error = await failure(loadSplats(new Blob([ply]), { format: format as never }));
  expect(error).toMatchObject({ argument: 'format' });
});

test('rows of a glTF whose nodes lie too far apart come with a note', async () => {
  useWorkers('works');
  const far = gltfOf(splatAttributes(randomSplats({ count: 300, shDegree: 0, logScales: [-4, -4] })));
  far.json.nodes = [[0, 0, 0] as const, [1e7, 0, 0] as const].map((translation) => ({
    mesh: 0,
    translation,
  }));
  far.json.scenes = [{ nodes: [0, 1] }];
  const sink = new RowList();
  await loadOrPass(knownSource(new File([glbBytes(far)], 'a.glb')), {}, { sink, files: FILES });
  expect(sink.notes).toEqual([expect.stringContaining('too far apart for float32')]);
  expect(FakeWorker.started.map(({ kind }) => kind)).toEqual(['formats']);
});

/** @fault Files: a glTF of Cesium's first tiles, or one packed by meshopt */
describe('a glTF that meshopt has packed', () => {
  const fixture = gltfOf(splatAttributes(randomSplats({ count: 300, shDegree: 1 })));
  const packedFile = async (change: (json: AnyJson) => void = () => {}) => {
    const file = await meshoptPacked(fixture);
    change(file.json);
    return new File([glbBytes(file)], 'a.glb');
  };

  test('is unpacked by the page, which alone fetches the code, and read in the worker', async () => {
    const file = await packedFile();
    const here = await loadSplats(file);
    useWorkers('works');
    expect(await loadSplats(file)).toEqual(here);
    expect(FakeWorker.started.map(({ kind }) => kind)).toEqual(['formats']);
    expect(here.count).toBe(300);
  });

  test('damaged, it ends the load', async () => {
    const file = await packedFile(
      (json) => json.bufferViews[0].extensions.EXT_meshopt_compression.byteLength--,
    );
    useWorkers('works');
    expect(await failure(loadSplats(file))).toMatchObject({ name: 'SplatFileError', code: 'damaged' });
  });
});

/**
 * @fault Files: the worker dies
 * @consequence `WebSplatterError` `worker-failed`
 */
test('a worker that dies', async () => {
  useWorkers('dies');
  const error = await failure(loadSplats(ply));
  expect(error).toBeInstanceOf(WebSplatterError);
  expect(error).toMatchObject({ code: 'worker-failed' });
  expect(error.message).toContain('out of memory');
});

describe('abort', () => {
  test('before anything', async () => {
    useWorkers('works');
    await expect(loadSplats(ply, { signal: AbortSignal.abort(new Error('no')) })).rejects.toThrow('no');
    expect(FakeWorker.started).toHaveLength(0);
  });

  test('while the worker starts', async () => {
    useWorkers('never starts');
    const controller = new AbortController();
    setTimeout(() => controller.abort(new Error('too slow')), 5);
    await expect(loadSplats(ply, { signal: controller.signal })).rejects.toThrow('too slow');
  });

  test.each<Behaviour>(['works', 'takes no streams', 'throws'])(
    'of a stalled stream, with a worker that %s',
    async (behaviour) => {
      useWorkers(behaviour);
      let cancelled: unknown;
      const stalled = new ReadableStream<Uint8Array>({
        start: (controller) => controller.enqueue(ply.slice(0, 3000)),
        cancel: (reason) => {
          cancelled = reason;
        },
      });
      const controller = new AbortController();
      setTimeout(() => controller.abort(new Error('enough')), 20);
      await expect(loadSplats(stalled, { signal: controller.signal })).rejects.toThrow('enough');
      await expect.poll(() => cancelled).toMatchObject({ message: 'enough' });
    },
  );

  /**
   * @fault Listeners: a callback of a load throws
   * @consequence the error is reported, the load goes on
   */
  test.each(['works', 'does not start'] as const)(
    'an error of a callback is reported, and ends no load where a worker %s',
    async (how) => {
      useWorkers(how);
      const reported = reportedErrors();
      const error = new Error('bad callback');
      const onProgress = () => {
        throw error;
      };
      expect((await loadSplats(ply, { onProgress })).count).toBe(300);
      expect(new Set(reported)).toEqual(new Set([error]));
    },
  );
});

/**
 * @fault Files: many loads at once
 * @consequence 2 to 8 workers take them in order
 */
describe('many loads at once', () => {
  const threads = (count: number) => vi.stubGlobal('navigator', { hardwareConcurrency: count });

  test('share as many workers as there are threads, 2 to 8, in the order in which they came', async () => {
    for (const [count, workers] of [
      [1, 2],
      [4, 4],
      [64, 8],
    ]) {
      useWorkers('works');
      threads(count);
      const done: number[] = [];
      const loads = Array.from({ length: 50 }, async (_, i) => {
        expect((await loadSplats(ply)).count).toBe(300);
        done.push(i);
      });
      await Promise.all(loads);
      expect(FakeWorker.started).toHaveLength(workers);
      for (const [place, i] of done.entries()) expect(Math.abs(place - i)).toBeLessThan(2 * workers);
      for (const worker of FakeWorker.started) expect(worker.isTerminated).toBe(true);
    }
  });

  /**
   * @fault Files: many loads at once, of which some fail or are aborted
   * @consequence others take their places
   */
  test('those that fail or are aborted make room for others', async () => {
    useWorkers('works');
    threads(2);
    const stalled = () => new ReadableStream<Uint8Array>({ pull: () => new Promise(() => {}) });
    const controllers = Array.from({ length: 4 }, () => new AbortController());
    const outcomes = controllers.map(({ signal }) => failure(loadSplats(stalled(), { signal })));
    const broken = failure(loadSplats(ply.slice(0, 1000)));
    const last = loadSplats(new Blob([ply]));
    // One that waits, one that runs, then all.
    for (const i of [3, 0, 1, 2]) controllers[i].abort(new Error(`stopped ${i}`));
    expect((await Promise.all(outcomes)).map(({ message }) => message)).toEqual(
      [0, 1, 2, 3].map((i) => `stopped ${i}`),
    );
    expect(await broken).toBeInstanceOf(SplatFileError);
    expect((await last).count).toBe(300);
  });

  test('take turns where no worker starts, too', async () => {
    useWorkers('throws');
    threads(1);
    let running = 0;
    let most = 0;
    const source = () => {
      most = Math.max(most, ++running);
      return ply;
    };
    const streamOf = () =>
      new ReadableStream<Uint8Array>(
        {
          pull(controller) {
            controller.enqueue(source());
            controller.close();
            running--;
          },
        },
        { highWaterMark: 0 },
      );
    const clouds = await Promise.all(Array.from({ length: 10 }, () => loadSplats(streamOf())));
    expect(clouds.map(({ count }) => count)).toEqual(Array(10).fill(300));
    expect(most).toBeLessThanOrEqual(2);
  });
});

describe('a lasting source', () => {
  test('is an address, as the page has it now, a Blob or a File', () => {
    vi.stubGlobal('document', { baseURI: 'https://example.org/scenes/' });
    expect(lastingSource('garden.ply')).toBe('https://example.org/scenes/garden.ply');
    expect(lastingSource(new URL('https://example.org/a.ply'))).toBe('https://example.org/a.ply');
    const blob = new Blob([ply]);
    expect(lastingSource(blob)).toBe(blob);
  });

  test('is no stream and no buffer', () => {
    expect(lastingSource(new ReadableStream())).toBeNull();
    expect(lastingSource(ply)).toBeNull();
    expect(lastingSource(ply.buffer)).toBeNull();
    for (const none of [null, undefined, 5, true, Symbol('s')])
      expect(() => lastingSource(none as never)).toThrow(/^source is .*; it must be a URL/);
  });
});

test.each([
  new SplatFileError('bad-value', 'a.ply', 'x.', { line: 3, property: 'y' }, { cause: new Error('why') }),
  new SplatFileError('unknown-format', 'a.ply', ['is an image', 'open a PLY', 'More.']),
  new SplatSourceError('a.ply', 'gone', 404),
  new InvalidArgumentError('source', 'wrong'),
  new WebSplatterError('something', 'else'),
  new Error('plain'),
])('%s survives being posted', (error) => {
  const back = fromPostedError(structuredClone(toPostedError(error)));
  expect(back.constructor).toBe(error.constructor);
  expect({ ...back, cause: String(back.cause) }).toEqual({ ...error, cause: String(error.cause) });
  expect(back.message).toBe(error.message);
  expect(back.stack).toContain(error.message);
  expect(back.name).toBe(error.name);
});
