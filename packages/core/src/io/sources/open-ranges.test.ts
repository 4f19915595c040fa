import { createServer, type IncomingMessage, type Server, type ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { brickSceneOf } from '../../data/bricks/make-bricks.ts';
import { SplatSourceError } from '../../data/errors.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { openBricks } from '../formats/bricks/open-bricks.ts';
import { write } from '../formats/bricks/write-bricks.ts';
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
  vi.mocked(waitMs).mockResolvedValue();
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
  const opened = await openRanges(source(), 100);
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
  const opened = await openRanges(url, 100);
  await opened.read(10, 20);
  await opened.read(90, 20);
  expect(ranges).toEqual(['0-99', '90-109']);
});

test('a part that breaks off is asked for again', async () => {
  const opened = await openRanges(url, 100);
  answer = (response, start, end) => {
    answer = sendPart;
    response.writeHead(206, { etag: '"1"', 'content-range': `bytes ${start}-${end - 1}/5000` });
    response.write(content.subarray(start, start + 10), () => response.destroy());
  };
  expect(await opened.read(1000, 500)).toEqual(file.slice(1000, 1500));
  expect(ranges).toEqual(['0-99', '1000-1499', '1000-1499']);
});

test.each<[string, Answer, string]>([
  ['sends whole files', (response) => response.end(file), 'answered 200 with the whole file'],
  ['sends another part', (response) => sendPart(response, 50, 60), 'sent another part'],
  ['has another file now', (response, start, end) => sendPart(response, start, end, '"2"'), 'has changed'],
  ['does not find it', (response) => response.writeHead(404).end(), 'the server answered 404'],
])('a server that %s', async (_, wrong, message) => {
  const opened = await openRanges(url, 100);
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
  const scene = await openBricks(url);
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
