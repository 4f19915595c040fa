import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import { afterEach, describe, expect, test, vi } from 'vitest';
import { WebSplatterError } from '../../data/errors.ts';
import { radFiles, randomNodes } from '../../testing/rad-fixture.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { streamedSog, streamedSogFiles } from '../../testing/streamed-sog-fixture.ts';
import { openBricks } from '../formats/bricks/open-bricks.ts';
import { write } from '../formats/bricks/write-bricks.ts';
import { openRadSource } from '../formats/rad/rad-source.ts';
import { REQUESTS_OF_FILE } from '../formats/sog/fetch-file.ts';
import { FILES_AT_ONCE, openLeaves } from '../formats/sog/open-leaves.ts';
import { FewRequests, MOST_REQUESTS } from './few-requests.ts';
import { knownSource } from './known-source.ts';
import { openRanges } from './open-ranges.ts';

describe('few requests', () => {
  test('run in order, as many at once as there may be, whether they fail or not', async () => {
    const requests = new FewRequests(2);
    const begun: number[] = [];
    const enders: (() => void)[] = [];
    const all = [0, 1, 2, 3].map((i) =>
      requests.run(async () => {
        begun.push(i);
        await new Promise<void>((resolve) => {
          enders[i] = resolve;
        });
        if (i === 0) throw new Error('no answer');
        return i;
      }, undefined),
    );
    const outcomes = Promise.allSettled(all);
    expect(begun).toEqual([0, 1]);
    enders[0]();
    await expect(all[0]).rejects.toThrow('no answer');
    await expect.poll(() => begun).toEqual([0, 1, 2]);
    enders[2]();
    await expect.poll(() => begun).toEqual([0, 1, 2, 3]);
    enders[1]();
    enders[3]();
    expect((await outcomes).map(({ status }) => status)).toEqual(['rejected', ...Array(3).fill('fulfilled')]);
  });

  test('leave while they wait, and give their turn to the next', async () => {
    const requests = new FewRequests(1);
    let end = () => {};
    const first = requests.run(
      () =>
        new Promise<void>((resolve) => {
          end = resolve;
        }),
      undefined,
    );
    const ender = new AbortController();
    const second = requests.run(async () => 'never', ender.signal);
    const third = requests.run(async () => 'third', undefined);
    ender.abort('enough');
    await expect(second).rejects.toBe('enough');
    await expect(requests.run(async () => 'never', AbortSignal.abort('before'))).rejects.toBe('before');
    end();
    await first;
    expect(await third).toBe('third');
    expect(await requests.run(async () => 'later', undefined)).toBe('later');
  });
});

describe('requests of one scene', () => {
  let server: Server | undefined;
  /** Requests so far, and most that were under way at once, from the call of `fetch` on. */
  let asked = 0;
  let most = 0;
  /** Whether an answer to a request may be sent by now. */
  let isDue = (_path: string) => true;

  /** Serves files by path, parts of them if `hasRanges`, of the size that it promises. */
  async function serve(
    fileAt: (path: string) => Uint8Array | undefined,
    hasRanges = false,
    promisedBytes?: number,
  ): Promise<string> {
    let underWay = 0;
    asked = 0;
    most = 0;
    isDue = () => true;
    const { fetch } = globalThis;
    vi.stubGlobal('fetch', (...request: Parameters<typeof fetch>) => {
      asked++;
      most = Math.max(most, ++underWay);
      return fetch(...request);
    });
    const held = new Map<() => void, string>();
    server = createServer((request, response) => {
      response.on('close', () => {
        underWay--;
      });
      const path = decodeURI(request.url!.slice(1));
      const file = fileAt(path);
      const [, from, to] = /bytes=(\d+)-(\d+)/.exec(request.headers.range ?? '') ?? [];
      const send = () => {
        if (!file) response.writeHead(404).end();
        else if (!hasRanges || from === undefined) response.end(file);
        else {
          const part = file.subarray(Number(from), Number(to) + 1);
          const range = `bytes ${from}-${Number(from) + part.length - 1}/${promisedBytes ?? file.length}`;
          response.writeHead(206, { 'content-range': range, etag: '"1"' }).end(part);
        }
      };
      held.set(send, path);
      for (const [each, heldPath] of held) {
        if (!isDue(heldPath)) continue;
        held.delete(each);
        each();
      }
    });
    await new Promise<void>((resolve) => server!.listen(0, '127.0.0.1', resolve));
    return `http://127.0.0.1:${(server.address() as AddressInfo).port}/`;
  }

  afterEach(() => {
    vi.unstubAllGlobals();
    server?.closeAllConnections();
    server?.close();
  });

  const content = () => write(randomSplats({ count: 3000, seed: 3, shDegree: 3 }), {});

  /**
   * @fault Servers: the first piece of a scene in bricks is empty, or has a few bytes
   * @consequence `SplatFileError` `truncated` after one request
   */
  test.each([0, 1, 16, 167, 168, 4000])(
    'a first piece of %i bytes is all there is of a scene in bricks',
    async (length) => {
      const bytes = await content();
      const base = await serve((path) => (path.endsWith('000') ? bytes.slice(0, length) : bytes));
      const error = await openBricks(knownSource(`${base}a.bricks.000`)).then(
        (scene) => scene.read(scene.root).catch((reason) => reason),
        (reason) => reason,
      );
      expect(error).toBeInstanceOf(WebSplatterError);
      expect(error).toMatchObject({ code: 'truncated' });
      expect(asked).toBe(1);
    },
  );

  /**
   * @fault Servers: a scene of any number of pieces, chunks, parts or images
   * @consequence at most 8 requests are in flight; none follows a failed one
   */
  test('are few for pieces that are small, and none follow one that failed', async () => {
    const bytes = new Uint8Array(1 << 20).map((_, i) => i);
    const pieceBytes = 1 << 14;
    const pieceOf = (path: string) => {
      const start = Number(/\d+$/.exec(path)![0]) * pieceBytes;
      return start < bytes.length ? bytes.subarray(start, start + pieceBytes) : undefined;
    };
    const base = await serve(pieceOf);
    const opened = await openRanges(knownSource(`${base}a.bricks.000`), 100);
    expect(await opened.read(0, bytes.length)).toEqual(bytes);
    expect(asked).toBe(bytes.length / pieceBytes);
    expect(most).toBeLessThanOrEqual(MOST_REQUESTS);
    await expect(opened.read(bytes.length, 1 << 30)).rejects.toThrow('404');
    expect(asked).toBeLessThanOrEqual(bytes.length / pieceBytes + MOST_REQUESTS);
  });

  test('are few for parts of one file that lie apart', async () => {
    const bytes = new Uint8Array(1 << 20).map((_, i) => i);
    const base = await serve(() => bytes, true);
    const opened = await openRanges(knownSource(`${base}a.bricks`), 100);
    const starts = Array.from({ length: 40 }, (_, i) => 1000 + 20_000 * i);
    const parts = await Promise.all(starts.map((start) => opened.read(start, 10)));
    expect(parts).toEqual(starts.map((start) => bytes.slice(start, start + 10)));
    expect(asked).toBe(41);
    expect(most).toBeLessThanOrEqual(MOST_REQUESTS);
  });

  /**
   * @fault Servers: a part of a file that promises more bytes than memory has
   * @consequence memory follows the bytes that have arrived
   */
  test('take no memory for bytes that are only promised', async () => {
    const base = await serve(() => new Uint8Array(1 << 20), true, Number.MAX_SAFE_INTEGER);
    const request = { maxRetries: 0 };
    const opened = await openRanges(knownSource(`${base}a.bricks`), 100, { request });
    await expect(opened.read(0, 2 ** 50)).rejects.toThrow('broke off');
  });

  test('are few for chunks of a .rad in files', async () => {
    const files = radFiles(randomNodes(4000, 1, true, 1, 0.4), { degree: 3, chunkSize: 100 });
    const name = Object.keys(files).find((path) => path.endsWith('.rad'))!;
    const base = await serve((path) => files[path], true);
    const source = (await openRadSource(knownSource(base + name), {}))!;
    const chunks = await Promise.all(source.header.chunks.map((_, i) => (i % 2 ? null : source.read(i))));
    expect(chunks.filter((chunk) => chunk && chunk.length > 0).length).toBeGreaterThan(MOST_REQUESTS);
    expect(most).toBeLessThanOrEqual(MOST_REQUESTS);
  });

  test('are few for the files of a streamed SOG', async () => {
    const set = randomSplats({ count: 3000, seed: 4, shDegree: 1, logScales: [-6, -4] });
    const sog = await streamedSog({ set, filesOfLevel: [6, 2], leafCount: 12 });
    const files = streamedSogFiles(sog, '');
    const base = await serve((path) => files[path]);
    const scene = (await openLeaves(knownSource(`${base}lod-meta.json`)))!;
    const numbers = new Set(scene.leaves.flatMap(({ levels }) => levels.map(({ file }) => file)));
    // Images of a file come once the metadata of two has been asked for.
    const metas = new Set<string>();
    isDue = (path) => {
      if (path.endsWith('.json')) metas.add(path);
      return path.endsWith('.json') || metas.size > 1;
    };
    await Promise.all([...numbers].map((file) => scene.read(file)));
    expect(most).toBeGreaterThan(2);
    expect(most).toBeLessThanOrEqual(FILES_AT_ONCE * REQUESTS_OF_FILE);
    scene.end();
  });
});
