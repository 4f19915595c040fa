import { createServer, type Server, type ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import { afterEach, beforeAll, beforeEach, expect, test } from 'vitest';
import type { Brick, BrickScene } from '../../data/bricks/brick.ts';
import { InvalidArgumentError, SplatFileError, SplatSourceError } from '../../data/errors.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { signalOf } from '../../testing/signal.ts';
import { openBricks } from '../formats/bricks/open-bricks.ts';
import { write } from '../formats/bricks/write-bricks.ts';
import { knownSource } from './known-source.ts';
import { openRanges } from './open-ranges.ts';

const PIECE_BYTES = 50_000;

let content: Uint8Array<ArrayBuffer>;
let pieces: Uint8Array<ArrayBuffer>[];
let asked: string[];
let answer: (response: ServerResponse, piece: Uint8Array | undefined) => void;
let server: Server;
let url: string;

const send: typeof answer = (response, piece) =>
  piece ? response.end(piece) : response.writeHead(404).end();

beforeAll(async () => {
  content = await write(randomSplats({ count: 9000, seed: 3, shDegree: 1 }), {});
  const count = Math.ceil(content.length / PIECE_BYTES);
  pieces = Array.from({ length: count }, (_, i) => content.slice(PIECE_BYTES * i, PIECE_BYTES * (i + 1)));
  expect(count).toBeGreaterThan(4);
});

beforeEach(async () => {
  asked = [];
  answer = send;
  // Answers no ranges.
  server = createServer((request, response) => {
    const [, number] = /^\/a\.bricks\.(\d{3})\?key=1$/.exec(request.url!)!;
    asked.push(number);
    answer(response, pieces[Number(number)]);
  });
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  url = `http://127.0.0.1:${(server.address() as AddressInfo).port}/a.bricks.000?key=1`;
});

afterEach(() => {
  server.closeAllConnections();
  server.close();
});

const filesOf = (numbers: readonly number[]) =>
  numbers.map((i) => new File([pieces[i]], `a.bricks.${String(i).padStart(3, '0')}`));
const numbers = () => pieces.map((_, i) => i);

async function allBricks(scene: BrickScene, address = scene.root): Promise<Brick[]> {
  const brick = await scene.read(address);
  const below = await Promise.all(brick.cells.map(({ child }) => (child ? allBricks(scene, child) : [])));
  return [brick, ...below.flat()];
}

test('a scene in pieces on a server has the same bricks, each piece asked for once', async () => {
  const scene = await openBricks(knownSource(url));
  expect(asked).toEqual(['000']);
  expect(await allBricks(scene)).toEqual(await allBricks(await openBricks(knownSource(content))));
  expect(asked.toSorted()).toEqual(pieces.map((_, i) => `00${i}`));
});

test('pieces that were opened together are one scene', async () => {
  const files = filesOf(numbers()).reverse();
  expect(await allBricks(await openBricks(knownSource({ files })))).toEqual(
    await allBricks(await openBricks(knownSource(content))),
  );
  const missing = filesOf(numbers().filter((i) => i !== 2));
  await expect(openBricks(knownSource({ files: missing }))).rejects.toThrow(SplatFileError);
  await expect(openBricks(knownSource({ files: missing }))).rejects.toThrow(
    'a.bricks.002 is not among the files',
  );
  await expect(openBricks(knownSource({ files: filesOf([1, 2]) }))).rejects.toThrow(InvalidArgumentError);
});

test('parts across pieces are read, up to the end of the file', async () => {
  const opened = await openRanges(knownSource(url), 100);
  for (const [offset, count] of [
    [0, 10],
    [PIECE_BYTES - 5, 10],
    [PIECE_BYTES - 5, PIECE_BYTES + 20],
    [content.length - 7, 7],
  ])
    expect(await opened.read(offset, count)).toEqual(content.slice(offset, offset + count));
  expect(await opened.read(content.length - 7, 9)).toEqual(content.slice(-7));
});

test('a piece that is not there, or larger than the first, is an error; it is asked for again', async () => {
  const opened = await openRanges(knownSource(url), 100);
  const read = () => opened.read(PIECE_BYTES, 10);
  answer = (response) => response.writeHead(404).end();
  await expect(read()).rejects.toThrow(SplatSourceError);
  answer = (response) => response.end(content);
  await expect(read()).rejects.toThrow('more than the 50000 of the first');
});

test('a piece is fetched as long as a read waits for it', async () => {
  const opened = await openRanges(knownSource(url), 100);
  const { when: begun, give: begin } = signalOf();
  const { when: closed, give: close } = signalOf();
  let finish = () => {};
  answer = (response, piece) => {
    finish = () => send(response, piece);
    response.on('close', close);
    begin();
  };
  const enders = [new AbortController(), new AbortController()];
  const [first, second] = enders.map(({ signal }) => opened.read(PIECE_BYTES, 10, signal));
  enders[0].abort('enough');
  await expect(first).rejects.toBe('enough');
  await begun;
  finish();
  expect(await second).toEqual(content.slice(PIECE_BYTES, PIECE_BYTES + 10));
  expect(asked).toEqual(['000', '001']);
  await closed;
  const { when: ended, give: end } = signalOf();
  const { when: sent, give: sendLast } = signalOf();
  answer = (response) => {
    response.on('close', end);
    sendLast();
  };
  const ender = new AbortController();
  const last = opened.read(2 * PIECE_BYTES, 10, ender.signal);
  await sent;
  ender.abort('enough');
  await expect(last).rejects.toBe('enough');
  await ended;
  answer = send;
  expect(await opened.read(2 * PIECE_BYTES, 10)).toEqual(
    content.slice(2 * PIECE_BYTES, 2 * PIECE_BYTES + 10),
  );
});
