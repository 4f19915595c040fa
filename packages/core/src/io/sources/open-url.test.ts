import { randomBytes } from 'node:crypto';
import { createServer, type IncomingMessage, type Server, type ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import { inspect } from 'node:util';
import { gzipSync } from 'node:zlib';
import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { InvalidArgumentError, SplatFileError, SplatSourceError } from '../../data/errors.ts';
import { plyBytes, splatElement } from '../../testing/ply-fixture.ts';
import { readSplats } from '../loading/read-splats.ts';
import type { ReadOptions, RequestOptions } from './splat-source.ts';
import { waitMs } from './wait-ms.ts';

const ply = plyBytes({ format: 'binary_little_endian', elements: [splatElement(2000, 1)] });

type Answer = (request: IncomingMessage, response: ServerResponse, attempt: number) => void;

/** The server's answer now, and the requests that it has had. */
let answer: Answer;
let requests: IncomingMessage[];
let server: Server;
let otherServer: Server;
let url: string;
let otherUrl: string;

const listen = async (listener: (request: IncomingMessage, response: ServerResponse) => void) => {
  const listening = createServer(listener);
  await new Promise<void>((resolve) => listening.listen(0, '127.0.0.1', resolve));
  const { port } = listening.address() as AddressInfo;
  return { listening, url: `http://127.0.0.1:${port}/scene.ply` };
};

// Servers of its own for each test: a connection that breaks at the end of one could be taken for
// the first request of the next, which no server would see.
beforeEach(async () => {
  const onRequest = (request: IncomingMessage, response: ServerResponse) => {
    requests.push(request);
    response.setHeader('connection', 'close');
    answer(request, response, requests.length);
  };
  ({ listening: server, url } = await listen(onRequest));
  ({ listening: otherServer, url: otherUrl } = await listen(onRequest));
});

/** How long requests would have waited, ms. */
const waitsMs: number[] = [];
vi.mock('./wait-ms.ts');

beforeEach(() => {
  requests = [];
  waitsMs.length = 0;
  vi.mocked(waitMs).mockClear();
  vi.mocked(waitMs).mockImplementation(async (ms) => void waitsMs.push(ms));
});

afterEach(() => {
  vi.restoreAllMocks();
  for (const each of [server, otherServer]) {
    each.closeAllConnections();
    each.close();
  }
});

const failure = async (promise: Promise<unknown>): Promise<Error> =>
  promise.then(
    () => expect.fail('should have been rejected'),
    (reason) => reason,
  );

/** Reads with `request` and returns the error. */
const failureOf = async (request: RequestOptions = {}, options: ReadOptions = {}) =>
  failure(readSplats(url, { ...options, request }));

/** Answers ranges as servers do that know the file by `etag`. */
function sendRange({ headers }: IncomingMessage, response: ServerResponse, etag: string): void {
  response.setHeader('etag', etag);
  const start = Number(/^bytes=(\d+)-$/.exec(headers.range ?? '')?.[1]);
  if (headers['if-range'] !== etag || Number.isNaN(start)) {
    response.setHeader('content-length', ply.length).end(ply);
    return;
  }
  const part = ply.subarray(start);
  response.writeHead(206, {
    'content-range': `bytes ${start}-${ply.length - 1}/${ply.length}`,
    'content-length': part.length,
  });
  response.end(part);
}

/** Sends `part` of a body that should be the whole file, and breaks the connection off. */
function breakOff(response: ServerResponse, part: Uint8Array): void {
  response
    .setHeader('content-length', ply.length)
    .write(part, () => setTimeout(() => response.destroy(), 20));
}

const CUT = 70_001;

describe('a server that cannot answer for the moment', () => {
  /**
   * @fault Servers: status 408, 425, 429, 502, 503 or 504
   * @consequence asked again four times, at growing intervals; then `SplatSourceError` with the status
   */
  test.each([408, 425, 429, 502, 503, 504])('%i is asked again, ever later', async (status) => {
    answer = (_, response, attempt) => {
      if (attempt < 4) response.writeHead(status).end('busy');
      else response.end(ply);
    };
    expect((await readSplats(url)).count).toBe(2000);
    expect(waitsMs).toHaveLength(3);
    for (const [i, ms] of waitsMs.entries()) {
      expect(ms).toBeGreaterThanOrEqual(250 * 2 ** i);
      expect(ms).toBeLessThanOrEqual(500 * 2 ** i);
    }
  });

  test('that never answers is given up', async () => {
    answer = (_, response) => void response.writeHead(503).end();
    expect(await failureOf()).toMatchObject({ name: 'SplatSourceError', status: 503 });
    expect(requests).toHaveLength(5);
    expect(await failureOf({ maxRetries: 0 })).toBeInstanceOf(SplatSourceError);
    expect(requests).toHaveLength(6);
  });

  /**
   * @fault Servers: `Retry-After`
   * @consequence is honoured
   */
  test('says when it wants to be asked again', async () => {
    const waits = ['3', new Date(Date.now() + 9000).toUTCString()];
    answer = (_, response, attempt) => {
      if (attempt <= 2) response.writeHead(429, { 'retry-after': waits[attempt - 1] }).end();
      else response.end(ply);
    };
    await readSplats(url);
    expect(waitsMs[0]).toBe(3000);
    expect(waitsMs[1]).toBeGreaterThan(7000);
    expect(waitsMs[1]).toBeLessThanOrEqual(9000);
    answer = (_, response) => void response.writeHead(503, { 'retry-after': '3600' }).end();
    expect(await failureOf()).toMatchObject({ status: 503 });
    expect(waitsMs).toHaveLength(2);
  });

  /**
   * @fault Servers: a `Retry-After` that is neither seconds nor a date
   * @consequence ignored
   */
  test.each(['-99999', '-1', '0.5', '99999 s', '1/1/2099', 'soon', ''])(
    'says %j, which is no time to be asked again, and is asked again',
    async (wanted) => {
      answer = (_, response, attempt) => {
        if (attempt === 1) response.writeHead(503, { 'retry-after': wanted }).end();
        else response.end(ply);
      };
      await readSplats(url);
      expect(waitsMs).toHaveLength(1);
      expect(waitsMs[0]).toBeLessThanOrEqual(500);
    },
  );

  /**
   * @fault Servers: any other status
   * @consequence `SplatSourceError` at once
   */
  test.each([400, 401, 403, 404, 410, 416, 500, 501])('%i is not asked again', async (status) => {
    answer = (_, response) => void response.writeHead(status).end();
    expect(await failureOf()).toMatchObject({ status });
    expect(requests).toHaveLength(1);
  });

  test('an abort ends the wait', async () => {
    answer = (_, response) => void response.writeHead(503).end();
    const { waitMs: reallyWait } = await vi.importActual<typeof import('./wait-ms.ts')>('./wait-ms.ts');
    vi.mocked(waitMs).mockImplementation(reallyWait);
    const controller = new AbortController();
    const reading = failureOf({}, { signal: controller.signal });
    await expect.poll(() => waitMs).toHaveBeenCalledTimes(1);
    controller.abort(new Error('no more'));
    expect((await reading).message).toBe('no more');
    expect(requests).toHaveLength(1);
  });

  test('a connection that breaks before any answer is tried once more', async () => {
    answer = ({ socket }) => void socket.destroy();
    expect((await failureOf()).message).toMatch(/cannot be fetched/);
    expect(requests).toHaveLength(2);
  });
});

describe('a transfer that breaks off', () => {
  /**
   * @fault Servers: the transfer breaks off
   * @consequence resumed by a range
   */
  test.each(['"v1"', null])('goes on where it was (etag %s)', async (etag) => {
    const date = 'Wed, 21 Oct 2015 07:28:00 GMT';
    answer = (request, response, attempt) => {
      if (etag) response.setHeader('etag', etag);
      else response.setHeader('last-modified', date);
      if (attempt === 1) breakOff(response, ply.subarray(0, CUT));
      else sendRange(request, response, etag ?? date);
    };
    expect(await readSplats(url)).toEqual(await readSplats(ply));
    expect(requests).toHaveLength(2);
    const { range, 'if-range': ifRange } = requests[1].headers;
    expect(ifRange).toBe(etag ?? date);
    // Bytes that were still on their way when the connection broke may be lost.
    expect(Number(range?.match(/\d+/)?.[0])).toBeLessThanOrEqual(CUT);
  });

  /**
   * @fault Servers: the transfer breaks off again and again
   * @consequence resumed a limited number of times, then `SplatSourceError`
   */
  test('again and again goes on as often as it may', async () => {
    const send: Answer = ({ headers }, response) => {
      const start = Number(/\d+/.exec(headers.range ?? '0')![0]);
      response.writeHead(headers.range ? 206 : 200, {
        etag: '"v1"',
        'content-length': ply.length - start,
        ...(headers.range && { 'content-range': `bytes ${start}-${ply.length - 1}/${ply.length}` }),
      });
      response.write(ply.subarray(start, start + 20_000), () => setTimeout(() => response.destroy(), 20));
    };
    answer = send;
    const error = await failureOf({ maxRetries: 3 });
    expect(error).toBeInstanceOf(SplatSourceError);
    expect(error.message).toContain('reading stopped');
    expect(requests).toHaveLength(4);
    requests = [];
    expect((await readSplats(url, { request: { maxRetries: 30 } })).count).toBe(2000);
    expect(requests.length).toBeGreaterThanOrEqual(ply.length / 20_000);
  });

  /**
   * @fault Servers: status 200 in answer to a range
   * @consequence the bytes that were read are skipped
   */
  test('goes on from a server that answers 200 to a range, with the same file', async () => {
    answer = (_, response, attempt) => {
      response.setHeader('etag', '"v1"');
      if (attempt === 1) breakOff(response, ply.subarray(0, CUT));
      else response.end(ply);
    };
    expect(await readSplats(url)).toEqual(await readSplats(ply));
  });

  test.each<[why: string, then: Answer, says: RegExp]>([
    ['the file has changed', (request, response) => sendRange(request, response, '"v2"'), /may have changed/],
    [
      'another part is sent',
      (_, response) => {
        const headers = { etag: '"v1"', 'content-range': `bytes 5-${ply.length - 1}/${ply.length}` };
        response.writeHead(206, headers).end(ply.subarray(5));
      },
      /another part/,
    ],
    [
      'the part does not say which it is',
      (_, response) => void response.writeHead(206, { etag: '"v1"' }).end(ply.subarray(CUT)),
      /does not say which part/,
    ],
    ['the range is refused', (_, response) => void response.writeHead(416).end(), /answered 416/],
  ])('fails where %s', async (_, then, says) => {
    answer = (request, response, attempt) => {
      response.setHeader('etag', '"v1"');
      if (attempt === 1) breakOff(response, ply.subarray(0, CUT));
      else then(request, response, attempt);
    };
    const error = await failureOf();
    expect(error).toBeInstanceOf(SplatSourceError);
    expect(error.message).toMatch(says);
    expect(requests).toHaveLength(2);
  });

  test('goes on where the server no longer says how long the file is', async () => {
    answer = (_, response, attempt) => {
      response.setHeader('etag', '"v1"');
      if (attempt === 1) breakOff(response, ply.subarray(0, CUT));
      // Without a length.
      else response.write(ply, () => response.end());
    };
    expect(await readSplats(url)).toEqual(await readSplats(ply));
  });

  test('and then answers no more fails as it broke off', async () => {
    answer = (request, response, attempt) => {
      response.setHeader('etag', '"v1"');
      if (attempt === 1) breakOff(response, ply.subarray(0, CUT));
      else request.socket.destroy();
    };
    expect((await failureOf()).message).toContain('reading stopped');
    expect(requests).toHaveLength(5);
  });

  /**
   * @fault Servers: a transfer from another origin, with fewer headers, breaks off
   * @consequence restarted; the bytes that were read are skipped
   */
  test('goes on from another origin, of which a page sees less and may ask less', async () => {
    const date = 'Wed, 21 Oct 2015 07:28:00 GMT';
    const really = globalThis.fetch;
    vi.spyOn(globalThis, 'fetch').mockImplementation(async (address, init) => {
      if (new Headers(init?.headers).has('if-range')) throw new TypeError('the preflight was refused');
      const response = await really(address, init);
      const seen = ['content-length', 'content-type', 'last-modified'];
      const headers = new Headers([...response.headers].filter(([name]) => seen.includes(name)));
      const { body, status } = response;
      return Object.defineProperty(new Response(body, { headers, status }), 'type', { value: 'cors' });
    });
    answer = (request, response, attempt) => {
      response.setHeader('last-modified', date);
      if (attempt === 1) breakOff(response, ply.subarray(0, CUT));
      else sendRange(request, response, date);
    };
    expect(await readSplats(url)).toEqual(await readSplats(ply));
    expect(requests).toHaveLength(2);
  });

  test.each<[what: string, headers: Record<string, string>]>([
    ['nothing', {}],
    ['a weak tag', { etag: 'W/"v1"' }],
  ])('fails at once where a server has %s to know the file by', async (_, headers) => {
    answer = (_, response) => {
      for (const [name, value] of Object.entries(headers)) response.setHeader(name, value);
      breakOff(response, ply.subarray(0, CUT));
    };
    expect((await failureOf()).message).toContain('reading stopped');
    expect(requests).toHaveLength(1);
  });

  /**
   * @fault Servers: a compressed response breaks off
   * @consequence `SplatSourceError` at once: compressed bytes have no ranges
   */
  test('fails at once where the server packs it', async () => {
    const packed = gzipSync(ply);
    answer = (_, response) => {
      response.writeHead(200, {
        etag: '"v1"',
        'content-encoding': 'gzip',
        'content-length': packed.length,
      });
      const half = packed.subarray(0, packed.length / 2);
      response.write(half, () => setTimeout(() => response.destroy(), 20));
    };
    expect(await failureOf()).toBeInstanceOf(SplatSourceError);
    expect(requests).toHaveLength(1);
  });
});

describe('a server that is slow', () => {
  /** Long enough for a server that answers at once, however busy the machine is. */
  const request = { idleTimeoutMs: 2000 };

  /**
   * @fault Servers: a server does not answer
   * @consequence asked twice, then `SplatSourceError`
   */
  test('to answer is asked twice', async () => {
    answer = () => {};
    expect((await failureOf({ idleTimeoutMs: 50 })).message).toContain('did not answer within 50 ms');
    expect(requests).toHaveLength(2);
  });

  /**
   * @fault Servers: a transfer stalls
   * @consequence resumed like one that breaks off
   */
  test('in the middle counts as gone; the file is resumed', async () => {
    answer = (request, response, attempt) => {
      response.setHeader('etag', '"v1"');
      if (attempt === 1) response.setHeader('content-length', ply.length).write(ply.subarray(0, CUT));
      else sendRange(request, response, '"v1"');
    };
    expect((await readSplats(url, { request })).count).toBe(2000);
    expect(requests).toHaveLength(2);
  });

  /**
   * @fault Servers: a server sends a few bytes at a time
   * @consequence `SplatSourceError`
   */
  test('and drips is not waited for', async () => {
    answer = (_, response) => {
      let at = 0;
      response.setHeader('content-length', ply.length);
      const drip = setInterval(() => response.write(ply.subarray(at, ++at)), 10);
      response.on('close', () => clearInterval(drip));
    };
    const error = await failureOf(request);
    expect(error).toBeInstanceOf(SplatSourceError);
    expect(error.message).toContain('less than 16384 bytes in 2000 ms');
  });

  test('may take its time for a small file', async () => {
    answer = (_, response) => {
      const small = plyBytes({ format: 'ascii', elements: [splatElement(2)] });
      response.write(small.subarray(0, 100));
      setTimeout(() => response.end(small.subarray(100)), 50);
    };
    expect((await readSplats(url, { request })).count).toBe(2);
  });
});

describe('a server that lies', () => {
  /** The header of `count` splats with a few of their rows. */
  const promising = (count: number) => {
    const text = Buffer.from(ply.subarray(0, 10_000))
      .toString('latin1')
      .replace('vertex 2000', `vertex ${count}`);
    return Buffer.from(text, 'latin1');
  };

  /**
   * @fault Servers: a server promises a length of 60 GB
   * @consequence memory follows the bytes that have arrived
   */
  test('about a length of 60 GB gets no memory for it', async () => {
    const body = promising(600_000_000);
    answer = (_, response) => {
      response.setHeader('content-length', 60e9).write(body, () => setTimeout(() => response.destroy(), 20));
    };
    const before = process.memoryUsage().arrayBuffers;
    const unlimited = { maxBytes: Number.POSITIVE_INFINITY, maxSplats: Number.POSITIVE_INFINITY };
    expect((await failureOf({}, unlimited)).message).toContain('reading stopped');
    expect(process.memoryUsage().arrayBuffers - before).toBeLessThan(16e6);
    expect(await failureOf()).toMatchObject({ name: 'SplatFileError', code: 'too-large' });
  });

  /**
   * @fault Servers: a server promises too small a length
   * @consequence `SplatFileError` `truncated`
   */
  test('by a length that is too small', async () => {
    answer = (_, response) => void response.setHeader('content-length', 5000).end(ply.subarray(0, 5000));
    expect(await failureOf()).toMatchObject({ name: 'SplatFileError', code: 'truncated' });
  });

  /**
   * @fault Servers: a server promises too large a length
   * @consequence the splats are read
   */
  test('by a length that is too large', async () => {
    answer = (_, response) => {
      response.setHeader('content-length', ply.length + 1000).write(ply);
    };
    // All splats have come; bytes that should follow them are not waited for.
    expect((await readSplats(url)).count).toBe(2000);
  });

  /**
   * @fault Servers: a server sends a page in place of the file
   * @consequence `unknown-format`, with advice
   */
  test('with a page in place of the file, whatever it calls it', async () => {
    answer = (_, response) => {
      response.setHeader('content-type', 'model/ply').end('<!doctype html><title>Sign in</title>');
    };
    expect((await failureOf()).message).toMatch(/web page.*check the URL/);
    answer = (_, response) => void response.setHeader('content-type', 'text/html').end(ply);
    expect((await readSplats(url)).count).toBe(2000);
  });

  /**
   * @fault Servers: redirects go in circles
   * @consequence `SplatSourceError`
   */
  test('in circles', async () => {
    answer = (_, response) => void response.writeHead(302, { location: '/scene.ply' }).end();
    expect((await failureOf()).message).toMatch(/cannot be fetched: redirect count exceeded/);
    // Twice the twenty that fetch follows.
    expect(requests.length).toBeLessThanOrEqual(42);
  });
});

describe('limits of servers', () => {
  /**
   * @fault Servers: a server sends a gzip bomb of 1 GB
   * @consequence `SplatFileError` `too-large`, early
   */
  test('a bomb of 1 GB ends early', async () => {
    const zeros = Buffer.alloc(1 << 20);
    const start = Buffer.from(
      Buffer.from(ply.subarray(0, ply.length - 2000 * 92))
        .toString('latin1')
        .replace('vertex 2000', 'vertex 11000000'),
      'latin1',
    );
    // Members of gzip may follow one another: a bomb without making a gigabyte here.
    const member = gzipSync(zeros);
    const bomb = Buffer.concat([gzipSync(start), ...Array<Buffer>(1024).fill(member)]);
    answer = (_, response) => {
      response.writeHead(200, { 'content-encoding': 'gzip', 'content-length': bomb.length }).end(bomb);
    };
    let loadedBytes = 0;
    const onProgress = (progress: { loadedBytes: number }) => {
      ({ loadedBytes } = progress);
    };
    const error = await failureOf({}, { onProgress });
    expect(error).toBeInstanceOf(SplatFileError);
    expect(error).toMatchObject({ code: 'too-large' });
    expect(error.message).toMatch(/more than \d+ bytes, unpacked\. Pass a larger maxBytes/);
    expect(loadedBytes).toBeLessThan(80e6);
  });

  /**
   * @fault Servers: a source has more than `maxBytes`
   * @consequence `SplatFileError` `too-large`, with the numbers
   */
  test('no more than maxBytes, packed or not, promised or not', async () => {
    const maxBytes = 100_000;
    answer = (_, response) => void response.setHeader('content-length', ply.length).end(ply);
    expect((await failureOf({}, { maxBytes })).message).toContain(
      `has ${ply.length} bytes, more than maxBytes`,
    );
    answer = (_, response) => {
      response.setHeader('content-encoding', 'gzip').end(gzipSync(ply));
    };
    expect(await failureOf({}, { maxBytes })).toMatchObject({ code: 'too-large', place: { byte: maxBytes } });
    expect((await readSplats(url, { maxBytes: ply.length })).count).toBe(2000);
  });

  /**
   * @fault Servers: a source has more than `maxSplats`
   * @consequence `SplatFileError` `too-large`, with the numbers
   */
  test('no more than maxSplats', async () => {
    answer = (_, response) => void response.end(ply);
    expect(await failureOf({}, { maxSplats: 1999 })).toMatchObject({ code: 'too-large' });
    expect((await readSplats(url, { maxSplats: 2000 })).count).toBe(2000);
  });

  test('limits hold for bytes in memory, if they are given', async () => {
    expect(await failure(readSplats(ply, { maxBytes: 10 }))).toMatchObject({ code: 'too-large' });
    expect(await failure(readSplats(new Blob([ply]), { maxSplats: 10 }))).toMatchObject({
      code: 'too-large',
    });
  });
});

describe('other addresses', () => {
  test('of Blobs and of data are read; a revoked one fails at once', async () => {
    const address = URL.createObjectURL(new Blob([ply]));
    expect((await readSplats(address)).count).toBe(2000);
    URL.revokeObjectURL(address);
    expect(await failure(readSplats(address))).toBeInstanceOf(SplatSourceError);
    expect((await readSplats(`data:;base64,${Buffer.from(ply).toString('base64')}`)).count).toBe(2000);
    expect(await failure(readSplats('data:;base64,€'))).toBeInstanceOf(SplatSourceError);
    expect(waitsMs).toEqual([]);
  });
});

describe('credentials', () => {
  const secret = { 'x-api-key': 'secret', authorization: 'Bearer secret' };

  test('headers are sent, also when a transfer goes on', async () => {
    answer = (request, response, attempt) => {
      response.setHeader('etag', '"v1"');
      if (attempt === 1) breakOff(response, ply.subarray(0, CUT));
      else sendRange(request, response, '"v1"');
    };
    await readSplats(url, { request: { headers: secret } });
    for (const { headers } of requests) expect(headers).toMatchObject(secret);
  });

  /**
   * @fault Servers: a redirect to another origin, with headers
   * @consequence refused: nothing is sent on
   * @fault Servers: credentials in headers
   * @consequence sent to their own origin only, and in no message
   */
  test('headers go to no other origin', async () => {
    answer = ({ headers }, response) => {
      if (headers.host === new URL(url).host) response.writeHead(302, { location: otherUrl }).end();
      else response.end(ply);
    };
    const error = await failureOf({ headers: { 'x-api-key': 'secret' } });
    expect(error).toBeInstanceOf(SplatSourceError);
    expect(error.message).toContain('a redirect, which requests with headers do not follow');
    expect(requests.filter(({ headers }) => headers.host === new URL(otherUrl).host)).toEqual([]);
    // Without a secret, redirects are followed.
    expect((await readSplats(url)).count).toBe(2000);
  });

  test('are of the same origin by default, and never in a message', async () => {
    const fetching = vi.spyOn(globalThis, 'fetch');
    answer = (_, response) => void response.writeHead(403).end();
    const error = await failureOf({ headers: secret });
    expect(fetching.mock.calls[0][1]).toMatchObject({ credentials: 'same-origin' });
    expect(inspect(error)).not.toContain('secret');
    const unsendable = await failureOf({ headers: { authorization: 'secret\n2' } });
    expect(inspect(unsendable)).not.toContain('secret');
  });

  /**
   * @fault Servers: a URL has credentials
   * @consequence `SplatSourceError` at once, with a remedy; sent nowhere, and in no message
   */
  test.each([
    [(address: string) => address.replace('://', '://user:secret@'), /pass them in request\.headers/],
    [(address: string) => address.replace('http://', '//user:secret@'), /only absolute/],
    [() => 'http://user:secret@[/', /only absolute/],
  ])('in an address are not sent, nor told', async (addressOf, advice) => {
    answer = (_, response) => void response.end(ply);
    const error = await failure(readSplats(addressOf(url)));
    expect(error).toBeInstanceOf(SplatSourceError);
    expect(error.message).toMatch(advice);
    expect(inspect(error)).not.toContain('secret');
    expect(requests).toHaveLength(0);
    expect(waitsMs).toEqual([]);
  });

  test.each<[form: string, headers: unknown]>([
    ['Headers', new Headers(secret)],
    ['a list', Object.entries(secret)],
    ['a Map', new Map(Object.entries(secret))],
  ])('in headers as %s are sent', async (_, headers) => {
    const fetching = vi.spyOn(globalThis, 'fetch');
    answer = (_, response) => void response.end(ply);
    await readSplats(url, { request: { headers: headers as never } });
    expect(requests[0].headers).toMatchObject(secret);
    expect(fetching.mock.calls[0][1]).toMatchObject({ redirect: 'error' });
  });
});

test.each<[name: string, options: ReadOptions]>([
  ['maxBytes', { maxBytes: 0 }],
  ['maxBytes', { maxBytes: Number.NaN }],
  ['maxSplats', { maxSplats: -1 }],
  ['maxSplats', { maxSplats: '5' as never }],
  ['credentials', { request: { credentials: 'all' as never } }],
  ['idleTimeoutMs', { request: { idleTimeoutMs: 0 } }],
  ['maxRetries', { request: { maxRetries: Number.POSITIVE_INFINITY } }],
  ['request', { request: null as never }],
  ['request', { request: 'x' as never }],
  ['name', { name: 5 as never }],
  ['name', { name: Symbol('s') as never }],
  ['headers', { request: { headers: { 'bad name': 'x' } } }],
  ['headers', { request: { headers: { name: 'line\nbreak' } } }],
])('%s that is no such thing is refused', async (argument, options) => {
  answer = (_, response) => void response.end(randomBytes(10));
  const error = await failure(readSplats(url, options));
  expect(error).toBeInstanceOf(InvalidArgumentError);
  expect(error).toMatchObject({ argument });
});
