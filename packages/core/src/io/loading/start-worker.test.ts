import { resolveObjectURL } from 'node:buffer';
import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';

const PAGE = 'https://example.org';
const OWN = `${PAGE}/assets/ply-worker.js`;
const FOREIGN = 'https://cdn.example.com/dist/ply-worker.js';

/** As in a browser: scripts of other origins are refused, and a Blob's imports are fetched. */
class FakeWorker {
  static asked: string[] = [];
  static imported: string[] = [];
  /** Whether scripts that may be fetched are there. */
  static areThere = true;
  onmessage: (() => void) | null = null;
  onerror: ((event: Partial<ErrorEvent>) => void) | null = null;
  isTerminated = false;

  constructor(url: string | URL) {
    const address = String(url);
    FakeWorker.asked.push(address);
    if (address.startsWith('https:') && !address.startsWith(PAGE))
      throw new DOMException('other origin', 'SecurityError');
    void this.#start(address);
  }

  terminate(): void {
    this.isTerminated = true;
  }

  async #start(address: string): Promise<void> {
    await null;
    if (address.startsWith('blob:'))
      FakeWorker.imported.push(await (resolveObjectURL(address) as Blob).text());
    if (FakeWorker.areThere) this.onmessage?.();
    else this.onerror?.({ preventDefault() {} });
  }
}

const warn = vi.spyOn(console, 'warn');

/** A page in which no worker has failed yet. */
async function freshStartWorker() {
  vi.resetModules();
  const { startWorker } = await import('./start-worker.ts');
  return (make: () => Worker, signal?: AbortSignal) => startWorker(async () => make, signal);
}

const maker = (url: string) => () => new Worker(new URL(url), { type: 'module' });

beforeEach(() => {
  warn.mockReset().mockImplementation(() => {});
  Object.assign(FakeWorker, { asked: [], imported: [], areThere: true });
  vi.stubGlobal('Worker', FakeWorker);
  vi.stubGlobal('location', new URL(PAGE));
  vi.stubGlobal('document', { baseURI: `${PAGE}/page.html` });
});

afterEach(() => {
  vi.unstubAllGlobals();
});

/**
 * @fault Files: the worker is of another origin
 * @consequence it is started from a Blob that imports it
 */
describe('a worker of another origin', () => {
  test('starts from a Blob that imports it, without a word', async () => {
    const startWorker = await freshStartWorker();
    expect(await startWorker(maker(FOREIGN))).toBeInstanceOf(FakeWorker);
    expect(FakeWorker.imported).toEqual([`import "${FOREIGN}";`]);
    expect(globalThis.Worker).toBe(FakeWorker);
    const blobUrl = FakeWorker.asked.at(-1)!;
    expect(resolveObjectURL(blobUrl), 'revoked').toBeUndefined();
    expect(warn).not.toHaveBeenCalled();
  });

  test('that cannot be imported is named on the console', async () => {
    const startWorker = await freshStartWorker();
    FakeWorker.areThere = false;
    expect(await startWorker(maker(FOREIGN))).toBeNull();
    expect(warn.mock.calls[0][0].message).toContain(`${FOREIGN} did not start as a worker`);
  });

  test('is not started for a load that has been aborted', async () => {
    const startWorker = await freshStartWorker();
    const signal = AbortSignal.abort(new Error('enough'));
    await expect(startWorker(maker(FOREIGN), signal)).rejects.toThrow('enough');
    expect(FakeWorker.asked).toEqual([]);
  });
});

describe('a worker that does not start', () => {
  /**
   * @fault Files: no worker starts
   * @consequence the calling thread reads; one `WebSplatterError` `worker-unavailable` on the console
   *   gives the URL and a remedy
   */
  test('is reported once, as a typed error that says what to do', async () => {
    const startWorker = await freshStartWorker();
    FakeWorker.areThere = false;
    for (let i = 0; i < 3; i++) expect(await startWorker(maker(OWN))).toBeNull();
    expect(FakeWorker.imported).toEqual([]);
    expect(warn).toHaveBeenCalledTimes(1);
    const [error] = warn.mock.calls[0];
    expect(error).toMatchObject({ name: 'WebSplatterError', code: 'worker-unavailable' });
    expect(error.message).toContain(`${OWN} did not start as a worker`);
    expect(error.message).toMatch(/@websplatter\/core\/load-worker.*setWorkerUrl.*worker-src/);
  });

  test('because a bundler removed its address is reported too', async () => {
    const startWorker = await freshStartWorker();
    const make = () => new Worker(new URL('./ply-worker.js', undefined), { type: 'module' });
    expect(await startWorker(make)).toBeNull();
    expect(warn.mock.calls[0][0].message).toContain('the bundler left the workers out');
    expect(globalThis.Worker).toBe(FakeWorker);
  });

  test('where there are none, as in Node, is no matter', async () => {
    const startWorker = await freshStartWorker();
    vi.stubGlobal('Worker', undefined);
    expect(await startWorker(maker(OWN))).toBeNull();
    expect(warn).not.toHaveBeenCalled();
  });
});
