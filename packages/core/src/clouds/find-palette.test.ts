import { MessageChannel, type MessagePort } from 'node:worker_threads';
import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { InvalidArgumentError, WebSplatterError } from '../errors.ts';
import { setWorkerUrl } from '../io/loading/hosted-worker.ts';
import { clusterHarmonics } from '../packing/cluster-harmonics.ts';
import type { PackedHarmonics } from '../packing/harmonics.ts';
import { packHarmonics } from '../packing/repack-harmonics.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { type FindPaletteOptions, findPalette } from './find-palette.ts';
import type { PaletteRequest } from './palette-messages.ts';
import { type PalettePort, servePalette } from './serve-palette.ts';

type Behaviour = 'works' | 'throws' | 'does not start' | 'never starts' | 'never answers' | 'dies';

/** A worker in this thread behind a real message channel: what crosses is cloned or transferred as between threads. */
class FakeWorker {
  static behaviour: Behaviour = 'works';
  static started: FakeWorker[] = [];
  static scripts: string[] = [];
  onmessage: ((event: MessageEvent) => void) | null = null;
  onerror: ((event: Partial<ErrorEvent>) => void) | null = null;
  onmessageerror: (() => void) | null = null;
  isTerminated = false;
  wasAsked = false;
  readonly #page: MessagePort;

  constructor(url: URL | string, options: WorkerOptions) {
    FakeWorker.scripts.push(/[^/]+$/.exec(String(url))![0]);
    expect(options.type).toBe('module');
    if (FakeWorker.behaviour === 'throws') throw new DOMException('not allowed here', 'SecurityError');
    FakeWorker.started.push(this);
    const { port1, port2 } = new MessageChannel();
    this.#page = port1;
    port1.on('message', (data) => this.onmessage?.({ data } as MessageEvent));
    if (FakeWorker.behaviour === 'does not start') setTimeout(() => this.onerror?.({ preventDefault() {} }));
    else if (FakeWorker.behaviour !== 'never starts') this.#serve(port2);
  }

  postMessage(request: PaletteRequest, transfer: Transferable[]): void {
    this.wasAsked = true;
    if (FakeWorker.behaviour === 'dies') setTimeout(() => this.onerror?.({ message: 'out of memory' }));
    else if (FakeWorker.behaviour !== 'never answers') this.#page.postMessage(request, transfer as never);
  }

  terminate(): void {
    this.isTerminated = true;
    this.#page.close();
  }

  #serve(inside: MessagePort): void {
    const port: PalettePort = {
      onmessage: null,
      postMessage: (reply, transfer) => inside.postMessage(reply, transfer as never),
    };
    inside.on('message', (data) => port.onmessage?.({ data } as MessageEvent<PaletteRequest>));
    servePalette(port);
  }
}

function useWorkers(behaviour: Behaviour): void {
  FakeWorker.behaviour = behaviour;
  vi.stubGlobal('Worker', FakeWorker);
}

beforeEach(() => {
  vi.spyOn(console, 'warn').mockImplementation(() => {});
});

afterEach(() => {
  vi.restoreAllMocks();
  for (const worker of FakeWorker.started) expect(worker.isTerminated).toBe(true);
  FakeWorker.started = [];
  FakeWorker.scripts = [];
  vi.unstubAllGlobals();
});

const COUNT = 400;
const harmonics = (): PackedHarmonics => packHarmonics(randomSplats({ count: COUNT }).harmonics);
const find = (given: PackedHarmonics, options: Partial<FindPaletteOptions> = {}) =>
  findPalette(given, COUNT, { entryCount: 32, name: 'garden', isGiven: false, ...options });
const failure = (promise: Promise<unknown>): Promise<Error> =>
  promise.then(
    () => expect.fail('should have been rejected'),
    (reason) => reason,
  );

describe.each<Behaviour>(['works', 'throws', 'does not start'])('a worker that %s', (behaviour) => {
  test('gives the palette that this thread would find, and tells how far it is', async () => {
    const here = await clusterHarmonics(harmonics(), COUNT, { entryCount: 32 });
    useWorkers(behaviour);
    const parts: number[] = [];
    const palette = await find(harmonics(), { onProgress: (part) => parts.push(part) });
    expect(palette).toEqual(here);
    expect(parts.at(-1)).toBe(1);
    expect(parts).toEqual(parts.toSorted((a, b) => a - b));
  });

  test('passes on typed errors', async () => {
    useWorkers(behaviour);
    const error = await failure(find(harmonics(), { entryCount: 0 }));
    expect(error).toBeInstanceOf(InvalidArgumentError);
    expect(error).toMatchObject({ argument: 'entryCount' });
    expect(error.message).toMatch(/^entryCount is 0; it must be a whole number from 1 to 65536/);
  });

  test('ends with an error of the callback', async () => {
    useWorkers(behaviour);
    const onProgress = () => {
      throw new Error('bad callback');
    };
    await expect(find(harmonics(), { onProgress })).rejects.toThrow('bad callback');
  });
});

test('the worker is the one for palettes, or the one that the page hosts', async () => {
  useWorkers('works');
  await find(harmonics());
  setWorkerUrl('https://example.org/load-worker.js');
  await find(harmonics()).finally(() => setWorkerUrl(null));
  expect(FakeWorker.scripts).toEqual(['palette-worker.ts', 'load-worker.js']);
});

test('memory is given away only where it may be', async () => {
  useWorkers('works');
  const [kept, given] = [harmonics(), harmonics()];
  await find(kept);
  expect(kept.words.length).toBe(45 * COUNT);
  await find(given, { isGiven: true });
  expect(given.words.length).toBe(0);
});

test('memory that was to be given away stays for this thread where no worker starts', async () => {
  useWorkers('does not start');
  expect((await find(harmonics(), { isGiven: true })).indices.length).toBe(COUNT);
});

test('a worker that dies is a typed error', async () => {
  useWorkers('dies');
  const error = await failure(find(harmonics()));
  expect(error).toBeInstanceOf(WebSplatterError);
  expect(error).toMatchObject({ code: 'worker-failed' });
  expect(error.message).toBe('garden: the palette worker stopped: out of memory.');
});

describe('abort', () => {
  test('before anything has begun starts no worker', async () => {
    useWorkers('works');
    await expect(find(harmonics(), { signal: AbortSignal.abort(new Error('no')) })).rejects.toThrow('no');
    expect(FakeWorker.started).toHaveLength(0);
  });

  test.each<Behaviour>(['never starts', 'never answers'])('stops a worker that %s', async (behaviour) => {
    useWorkers(behaviour);
    const controller = new AbortController();
    const outcome = failure(find(harmonics(), { signal: controller.signal }));
    await expect.poll(() => FakeWorker.started[0]?.wasAsked).toBe(behaviour === 'never answers');
    controller.abort(new Error('enough'));
    expect((await outcome).message).toBe('enough');
  });

  test('stops work in this thread', async () => {
    useWorkers('throws');
    const controller = new AbortController();
    const onProgress = () => controller.abort(new Error('enough'));
    await expect(find(harmonics(), { signal: controller.signal, onProgress })).rejects.toThrow('enough');
  });
});

test('no more palettes are found at once than the machine has threads', async () => {
  useWorkers('works');
  vi.stubGlobal('navigator', { hardwareConcurrency: 2 });
  let most = 0;
  const onProgress = () => {
    most = Math.max(most, FakeWorker.started.filter(({ isTerminated }) => !isTerminated).length);
  };
  await Promise.all(Array.from({ length: 6 }, () => find(harmonics(), { onProgress })));
  expect(FakeWorker.started).toHaveLength(6);
  expect(most).toBe(2);
});
