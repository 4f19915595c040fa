import { createServer, type IncomingMessage, type Server, type ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import { gzipSync } from 'node:zlib';
import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { brickSceneOf } from '../../data/bricks/make-bricks.ts';
import { SplatSourceError } from '../../data/errors.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { signalOf } from '../../testing/signal.ts';
import { openBricks } from '../formats/bricks/open-bricks.ts';
import { write } from '../formats/bricks/write-bricks.ts';
import { knownSource } from './known-source.ts';
import { openRanges } from './open-ranges.ts';
import { waitMs } from './wait-ms.ts';

vi.mock('./wait-ms.ts');

const file = Uint8Array.from({ length: 5000 }, (_, i) => 7 * i);

type Answer = (response: ServerResponse, start: number, end: number) => void;

let content: Uint8Array;
let answer: Answer;
let ranges: string[];
let server: Server;
let url: string;

/** Answers as servers do that know the file by `etag`. */
const sendPart = (response: ServerResponse, start: number, end: number, etag = '"1"') => {
  const part = content.subarray(start, end);
  response.writeHead(206, {
    etag,
    'content-range': `bytes ${start}-${start + part.length - 1}/${content.length}`,
    'content-length': part.length,
  });
  response.end(part);
};

beforeEach(async () => {
  content = file;
  answer = sendPart;
  ranges = [];
  vi.mocked(waitMs).mockReset().mockResolvedValue();
  server = createServer((request: IncomingMessage, response) => {
    const [, start, last] = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? '') ?? [];
    ranges.push(`${start}-${last}`);
    response.setHeader('connection', 'close');
    if (Number(start) >= content.length) response.writeHead(416).end();
    else answer(response, Number(start), Number(last) + 1);
  });
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  url = `http://127.0.0.1:${(server.address() as AddressInfo).port}/a.bricks`;
});

afterEach(() => {
  vi.restoreAllMocks();
  server.closeAllConnections();
  server.close();
});

test.each([
  ['a buffer', () => file],
  ['a Blob', () => new Blob([file])],
  ['a data: address', () => `data:,${'%07'.repeat(5)}`],
  ['an address', () => url],
])('parts of %s are read, up to its end', async (name, source) => {
  const opened = await openRanges(knownSource(source()), 100);
  const whole = name.startsWith('a data') ? new Uint8Array(5).fill(7) : file;
  expect(opened.totalBytes).toBe(whole.length);
  for (const [offset, count] of [
    [0, 100],
    [2, 3],
    [4000, 700],
    [4990, 100],
    [6000, 10],
  ])
    expect(await opened.read(offset, count)).toEqual(whole.slice(offset, offset + count));
  await expect(opened.read(0, 9, AbortSignal.abort('stop'))).rejects.toBe('stop');
});

test('the first bytes are asked for once', async () => {
  const opened = await openRanges(knownSource(url), 100);
  await opened.read(10, 20);
  const parts = await Promise.all([opened.read(90, 20), opened.read(110, 5)]);
  expect(parts).toEqual([file.slice(90, 110), file.slice(110, 115)]);
  expect(ranges).toEqual(['0-99', '100-114']);
});

/** Breaks the next answer off after ten bytes. */
const breakOff = (headers: Record<string, string>) => {
  const before = answer;
  answer = (response, start, end) => {
    answer = before;
    response.writeHead(206, { ...headers, 'content-range': `bytes ${start}-${end - 1}/5000` });
    response.write(content.subarray(start, start + 10), () => response.destroy());
  };
};

test('a part that breaks off goes on where it was', async () => {
  const opened = await openRanges(knownSource(url), 100);
  breakOff({ etag: '"1"' });
  expect(await opened.read(1000, 500)).toEqual(file.slice(1000, 1500));
  expect(ranges).toEqual(['0-99', '1000-1499', '1010-1499']);
});

test('a part that a server cuts short goes on where it was', async () => {
  const opened = await openRanges(knownSource(url), 100);
  answer = (response, start, end) => sendPart(response, start, Math.min(end, start + 200));
  expect(await opened.read(1000, 500)).toEqual(file.slice(1000, 1500));
  expect(ranges.slice(1)).toEqual(['1000-1499', '1200-1499', '1400-1499']);
});

test.each([[{}], [{ etag: 'W/"1"' }]])(
  'a part of what may be another file begins again: %j',
  async (known) => {
    answer = (response, start, end) => {
      response.setHeader('content-range', `bytes ${start}-${end - 1}/5000`);
      response.writeHead(206, known).end(content.subarray(start, end));
    };
    const opened = await openRanges(knownSource(url), 100);
    breakOff(known);
    expect(await opened.read(1000, 500)).toEqual(file.slice(1000, 1500));
    expect(ranges).toEqual(['0-99', '1000-1499', '1000-1499']);
  },
);

test('a file that changes while a part has broken off is noticed, and asked for no more', async () => {
  const opened = await openRanges(knownSource(url), 100);
  answer = (response, start, end) => sendPart(response, start, end, '"2"');
  breakOff({ etag: '"1"' });
  await expect(opened.read(1000, 500)).rejects.toThrow('has changed on its server');
  expect(ranges.length).toBe(3);
});

test('a file with another date, or another size, has changed', async () => {
  const dated = (date: string, size: number) => (response: ServerResponse, start: number, end: number) => {
    const range = `bytes ${start}-${end - 1}/${size}`;
    const headers = { 'last-modified': date, 'content-range': range };
    response.writeHead(206, headers).end(content.subarray(start, end));
  };
  const [first, second] = ['Thu, 01 Jan 2026 00:00:00 GMT', 'Fri, 02 Jan 2026 00:00:00 GMT'];
  answer = dated(first, 5000);
  const opened = await openRanges(knownSource(url), 100);
  expect(await opened.read(1000, 10)).toEqual(file.slice(1000, 1010));
  for (const changed of [dated(second, 5000), dated(first, 5001)]) {
    answer = changed;
    await expect(opened.read(1000, 10)).rejects.toThrow('has changed on its server');
  }
});

test('a file that becomes shorter has changed', async () => {
  const opened = await openRanges(knownSource(url), 100);
  content = file.subarray(0, 900);
  await expect(opened.read(800, 500)).rejects.toThrow('has changed on its server');
  await expect(opened.read(1000, 500)).rejects.toThrow('has changed on its server');
});

test('a server that is busy is asked again when it says, as often as is asked for', async () => {
  const opened = await openRanges(knownSource(url), 100, { request: { maxRetries: 3 } });
  answer = (response) => {
    if (ranges.length === 4) answer = sendPart;
    const when = ranges.length === 3 ? new Date(Date.now() + 20_000).toUTCString() : '7';
    response.writeHead(503, { 'retry-after': when }).end();
  };
  expect(await opened.read(1000, 500)).toEqual(file.slice(1000, 1500));
  const waits = vi.mocked(waitMs).mock.calls.map(([ms]) => ms);
  expect(waits).toEqual([7000, expect.any(Number), 7000]);
  expect(waits[1]).toBeGreaterThan(15_000);
  expect(waits[1]).toBeLessThanOrEqual(20_000);
  answer = (response) => response.writeHead(429, { 'retry-after': '3600' }).end();
  await expect(opened.read(1000, 500)).rejects.toThrow('the server answered 429');
  expect(waitMs).toHaveBeenCalledTimes(3);
});

test('a server that is gone for a moment is asked as often as any', async () => {
  const opened = await openRanges(knownSource(url), 100);
  answer = (response) => {
    if (ranges.length === 4) answer = sendPart;
    response.destroy();
  };
  expect(await opened.read(1000, 500)).toEqual(file.slice(1000, 1500));
  expect(ranges.length).toBe(5);
});

test('a part that stalls is asked for again', async () => {
  const opened = await openRanges(knownSource(url), 100, { request: { idleTimeoutMs: 1000 } });
  answer = (response, start, end) => {
    answer = sendPart;
    response.writeHead(206, { etag: '"1"', 'content-range': `bytes ${start}-${end - 1}/5000` });
    response.write(content.subarray(start, start + 10));
  };
  expect(await opened.read(1000, 500)).toEqual(file.slice(1000, 1500));
  expect(ranges).toEqual(['0-99', '1000-1499', '1010-1499']);
});

test('parts that lie next to each other are one request, in which each comes by itself', async () => {
  const opened = await openRanges(knownSource(url), 100);
  let finish = () => {};
  answer = (response, start, end) => {
    response.writeHead(206, { etag: '"1"', 'content-range': `bytes ${start}-${end - 1}/5000` });
    response.write(content.subarray(start, start + 250));
    finish = () => response.end(content.subarray(start + 250, end));
  };
  const parts = [1100, 1200, 1000].map((offset) => opened.read(offset, 100));
  expect(await parts[0]).toEqual(file.slice(1100, 1200));
  expect(await parts[2]).toEqual(file.slice(1000, 1100));
  expect(ranges).toEqual(['0-99', '1000-1299']);
  finish();
  expect(await parts[1]).toEqual(file.slice(1200, 1300));
  answer = sendPart;
  await Promise.all([opened.read(2000, 10), opened.read(2011, 10)]);
  expect(ranges.slice(2).sort()).toEqual(['2000-2009', '2011-2020']);
});

test('large parts are requests of their own', async () => {
  content = new Uint8Array(1_000_000);
  const opened = await openRanges(knownSource(url), 100);
  await Promise.all([100, 200_100, 400_100].map((offset) => opened.read(offset, 200_000)));
  expect(ranges.slice(1).sort()).toEqual(['100-400099', '400100-600099']);
});

test('a part that is called off leaves others alone; the last one ends the request', async () => {
  const opened = await openRanges(knownSource(url), 100);
  const { when: begun, give: begin } = signalOf();
  const { when: closed, give: close } = signalOf();
  answer = (response) => {
    response.on('close', close);
    begin();
  };
  const enders = [new AbortController(), new AbortController(), new AbortController()];
  const parts = enders.map(({ signal }, i) => opened.read(1000 + 100 * i, 100, signal));
  const ends = Promise.allSettled(parts);
  enders[0].abort('early');
  await begun;
  for (const ender of enders.slice(1)) ender.abort('late');
  const reasons = (await ends).map((end) => end.status === 'rejected' && end.reason);
  expect(reasons).toEqual(['early', 'late', 'late']);
  await closed;
  answer = sendPart;
  const [first, second] = [opened.read(1000, 100, enders[0].signal), opened.read(1100, 100)];
  await expect(first).rejects.toBe('early');
  expect(await second).toEqual(file.slice(1100, 1200));
  expect(ranges.length).toBe(3);
});

test('a small file of a server that sends whole ones is kept', async () => {
  answer = (response) => response.end(content);
  const opened = await openRanges(knownSource(url), 100);
  expect(opened.totalBytes).toBe(5000);
  expect(await opened.read(4000, 700)).toEqual(file.slice(4000, 4700));
  expect(ranges.length).toBe(1);
});

/** Most bytes that are fetched whole. */
const MOST_BYTES = 64 << 20;

/** Sends zeros without an end, in an answer with these headers; tells how many, and when the client leaves. */
function sendForEver(headers: Record<string, string | number>) {
  const { when: left, give } = signalOf();
  const sent = { bytes: 0, left };
  answer = (response) => {
    response.on('close', give);
    response.writeHead(200, headers);
    const piece = new Uint8Array(1 << 20);
    const more = () => {
      sent.bytes += piece.length;
      response.write(piece, (error) => error ?? more());
    };
    more();
  };
  return sent;
}

test.each<[string, Record<string, string | number>, number]>([
  ['its length says so, before it is read', { 'content-length': MOST_BYTES + 1 }, 8 << 20],
  ['no length is told, once that much is read', { 'accept-ranges': 'none' }, 2 * MOST_BYTES],
])(
  'a file of more than 64 MiB from a server that sends whole ones is refused: %s',
  async (_, headers, most) => {
    const sent = sendForEver(headers);
    const error = await openRanges(knownSource(url), 100).catch((reason) => reason);
    expect(error).toBeInstanceOf(SplatSourceError);
    expect(error).toMatchObject({ code: 'unreadable-source', status: 200 });
    expect(error.message).toMatch(/whole file, of more than 64 MiB.* cut it by "websplatter split"/);
    await sent.left;
    expect(sent.bytes).toBeLessThanOrEqual(most);
  },
);

test('a file that unpacks to more than 64 MiB is refused, however short its transfer is', async () => {
  const packed = gzipSync(new Uint8Array(MOST_BYTES + 1));
  answer = (response) =>
    response.writeHead(200, { 'content-encoding': 'gzip', 'content-length': packed.length }).end(packed);
  await expect(openRanges(knownSource(url), 100)).rejects.toThrow('the whole file, of more than 64 MiB');
});

test('a file of 64 MiB without a length is kept, however it arrives', async () => {
  content = new Uint8Array(MOST_BYTES).fill(7, -10);
  answer = (response) => {
    response.writeHead(200);
    for (let at = 0; at < content.length; at += 1 << 24) response.write(content.subarray(at, at + (1 << 24)));
    response.end();
  };
  const opened = await openRanges(knownSource(url), 100);
  expect(opened.totalBytes).toBe(MOST_BYTES);
  expect(await opened.read(MOST_BYTES - 11, 20)).toEqual(Uint8Array.from([0, ...Array(10).fill(7)]));
});

test('fetching a whole file can be called off, and is begun again where it broke off', async () => {
  const sent = sendForEver({});
  const ender = new AbortController();
  const opening = openRanges(knownSource(url), 100, { signal: ender.signal });
  await expect.poll(() => sent.bytes).toBeGreaterThan(2 << 20);
  ender.abort('enough');
  await expect(opening).rejects.toBe('enough');
  await sent.left;
  answer = (response) => {
    answer = (again) => again.writeHead(200, { etag: '"1"', 'content-length': 5000 }).end(content);
    response.writeHead(200, { etag: '"1"', 'content-length': 5000 });
    response.write(content.subarray(0, 10), () => response.destroy());
  };
  const opened = await openRanges(knownSource(url), 100);
  expect(await opened.read(0, 6000)).toEqual(file);
});

test.each<[string, Answer, string]>([
  ['sends whole files', (response) => response.end(file), 'answered 200 with the whole file'],
  ['sends another part', (response) => sendPart(response, 50, 60), 'sent another part'],
  ['has another file now', (response, start, end) => sendPart(response, start, end, '"2"'), 'has changed'],
  ['does not find it', (response) => response.writeHead(404).end(), 'the server answered 404'],
])('a server that %s', async (_, wrong, message) => {
  const opened = await openRanges(knownSource(url), 100);
  answer = wrong;
  const error = await opened.read(1000, 10).then(
    () => undefined,
    (reason) => reason,
  );
  expect(error).toBeInstanceOf(SplatSourceError);
  expect(error.message).toContain(message);
});

test('a scene in bricks asks for its bricks alone', async () => {
  const set = randomSplats({ count: 9000, shDegree: 2 });
  content = await write(set, {});
  const scene = await openBricks(knownSource(url));
  const root = await scene.read(scene.root);
  const { child } = root.cells[0];
  const level = await scene.read(child!);
  expect(ranges).toEqual(['0-131071']);
  const last = level.cells[2].child!;
  const brick = await scene.read(last);
  expect(ranges).toEqual(['0-131071', `${last.offset}-${last.offset + last.bytes - 1}`]);
  expect(last.offset + last.bytes).toBe(content.length);
  expect(brick.cells.length).toBe((await brickSceneOf(set).read(last)).cells.length);
});
