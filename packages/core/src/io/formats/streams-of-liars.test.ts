import { createServer, type Server, type ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import { gzipSync } from 'node:zlib';
import { afterEach, beforeAll, describe, expect, test } from 'vitest';
import type { BrickAddress, BrickScene } from '../../data/bricks/brick.ts';
import type { LeafScene, SplatCells } from '../../data/bricks/leaf-scene.ts';
import { SplatFileError, SplatSourceError } from '../../data/errors.ts';
import { radBytes, randomNodes } from '../../testing/rad-fixture.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { droppedFiles } from '../../testing/sog-fixture.ts';
import { streamedSog, streamedSogFiles } from '../../testing/streamed-sog-fixture.ts';
import { knownSource } from '../sources/known-source.ts';
import { openBricks } from './bricks/open-bricks.ts';
import { write } from './bricks/write-bricks.ts';
import { openRad } from './rad/open-rad.ts';
import { openLeaves } from './sog/open-leaves.ts';

// Servers of streamed scenes that lie about one part, which is read after the scene was opened.

/** What a server would answer in truth. */
interface Truth {
  readonly bytes: Uint8Array;
  readonly status: number;
  readonly headers: Readonly<Record<string, string | number>>;
}
type Lie = (response: ServerResponse, truth: Truth) => void;

const PAGE = Buffer.from('<!doctype html><title>Please sign in</title>'.padEnd(4000));
/** Unpacks to far more than any file of these scenes has. */
const BOMB = gzipSync(Buffer.alloc(16 << 20));
/** Unpacks to more than is kept of the answer to a request for a range. */
const BOMB_FOR_RANGE = Buffer.concat(Array(5).fill(BOMB));
const REQUEST = { maxRetries: 1, idleTimeoutMs: 500 };

const answer = (response: ServerResponse, { status, headers }: Truth, bytes: Uint8Array) =>
  response.writeHead(status, { ...headers, 'content-length': bytes.length }).end(bytes);

/** Lies about any part, and the errors that they may lead to. */
const LIES: Readonly<
  Record<string, readonly [lie: Lie, ...errors: (typeof SplatFileError | typeof SplatSourceError)[]]>
> = {
  'a page of its own': [(response, truth) => answer(response, truth, PAGE), SplatFileError, SplatSourceError],
  nothing: [
    (response, truth) => answer(response, truth, new Uint8Array(0)),
    SplatFileError,
    SplatSourceError,
  ],
  'half of it': [
    (response, truth) => answer(response, truth, truth.bytes.subarray(0, truth.bytes.length >> 1)),
    SplatFileError,
    SplatSourceError,
  ],
  'half of what it promises': [
    (response, { status, headers, bytes }) => {
      response.writeHead(status, headers);
      response.write(bytes.subarray(0, bytes.length >> 1), () => response.destroy());
    },
    SplatSourceError,
  ],
  'some bytes, and no more for ever': [
    (response, { status, headers, bytes }) => {
      response.writeHead(status, headers);
      response.write(bytes.subarray(0, 9));
    },
    SplatSourceError,
  ],
  'other bytes in the middle': [
    (response, truth) => {
      const bytes = truth.bytes.slice();
      bytes.fill(0, bytes.length >> 2, bytes.length >> 1);
      answer(response, truth, bytes);
    },
    SplatFileError,
  ],
  'that it is gone': [(response) => response.writeHead(410).end(), SplatSourceError],
  'that one must pay': [(response) => response.writeHead(402).end(PAGE), SplatSourceError],
  'a bomb': [
    (response, { status, headers }) => {
      const bomb = status === 206 ? BOMB_FOR_RANGE : BOMB;
      response
        .writeHead(status, { ...headers, 'content-encoding': 'gzip', 'content-length': bomb.length })
        .end(bomb);
    },
    SplatFileError,
    SplatSourceError,
  ],
};

let server: Server;
afterEach(() => {
  server.closeAllConnections();
  server.close();
});

/** Serves files with ranges; returns its address. `lieAt` tells which answers are lies, and which. */
async function serve(
  files: Readonly<Record<string, Uint8Array>>,
  lieAt: (path: string, from: number) => Lie | null,
): Promise<string> {
  server = createServer((request, response) => {
    const path = decodeURI(request.url!.slice(1));
    const file = files[path];
    if (!file) return response.writeHead(404).end();
    const [, from, to] = /bytes=(\d+)-(\d*)/.exec(request.headers.range ?? '') ?? [];
    const start = Number(from ?? 0);
    const end = from === undefined ? file.length : Math.min(file.length, to ? Number(to) + 1 : file.length);
    const bytes = file.subarray(start, end);
    const range = from !== undefined && { 'content-range': `bytes ${start}-${end - 1}/${file.length}` };
    const headers = { etag: '"1"', 'accept-ranges': 'bytes', 'content-length': bytes.length, ...range };
    const truth = { bytes, status: range ? 206 : 200, headers };
    const lie = lieAt(path, start);
    if (lie) lie(response, truth);
    else answer(response, truth, bytes);
  });
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  return `http://127.0.0.1:${(server.address() as AddressInfo).port}/`;
}

/** The finest level of the leaf that a file has. */
async function finestOf(scene: LeafScene, file: number): Promise<SplatCells[]> {
  const leaf = scene.leaves.find(({ levels }) => levels[0].file === file)!;
  const [pieces] = await (await scene.read(file)).pack([{ leaf, level: leaf.levels[0] }]);
  return pieces;
}

/** The bricks below the first cell of the root. */
async function lowestOf(scene: BrickScene): Promise<BrickAddress[]> {
  const { cells } = await scene.read(scene.root);
  return (await scene.read(cells[0].child!)).cells.map(({ child }) => child!);
}

/** An opened scene, and reads of two of its parts. */
interface OpenedParts {
  readonly readLied: () => Promise<unknown>;
  readonly readOther: () => Promise<unknown>;
  readonly end: () => void;
}

/** Opens a scene in leaves; parts are files. */
async function leafParts(
  opening: Promise<LeafScene | null>,
  { lied, other }: { readonly lied: number; readonly other: number },
): Promise<OpenedParts> {
  const scene = (await opening)!;
  return {
    readLied: () => finestOf(scene, lied),
    readOther: () => finestOf(scene, other),
    end: scene.end,
  };
}

/** An opened scene in bricks; parts are the last and the first of its lowest bricks. */
async function brickParts(scene: BrickScene): Promise<OpenedParts> {
  const lowest = await lowestOf(scene);
  return {
    readLied: () => scene.read(lowest.at(-1)!),
    readOther: () => scene.read(lowest[0]),
    end: scene.end,
  };
}

/** What two parts of a scene hold. */
interface Contents {
  readonly expected: unknown;
  readonly expectedOther: unknown;
}

async function contentsOf({ readLied, readOther, end }: OpenedParts): Promise<Contents> {
  const contents = { expected: await readLied(), expectedOther: await readOther() };
  end();
  return contents;
}

/**
 * Expects a typed error for one part, or its splats; no trouble with another; and the truth when that is
 * told again.
 */
async function expectHonesty(
  scene: OpenedParts,
  { expected, expectedOther }: Contents,
  setLie: (lie: Lie | null) => void,
  kind: string,
): Promise<void> {
  const [lie, ...errors] = LIES[kind];
  setLie(lie);
  const found = await scene.readLied().catch((reason) => reason);
  // What is cut may be resumed where it ended.
  if (!(found instanceof Error)) expect(found).toEqual(expected);
  else {
    expect(
      errors.some((each) => found instanceof each),
      String(found),
    ).toBe(true);
    expect(found.message).toMatch(/^\S+.*: /);
  }
  expect(await scene.readOther()).toEqual(expectedOther);
  setLie(null);
  expect(await scene.readLied()).toEqual(expected);
  scene.end();
}

/**
 * @fault Servers: a streamed SOG, .rad or .bricks, a part of which is a page, empty, cut, stuck, damaged,
 *   gone or a bomb
 * @consequence `SplatFileError` or `SplatSourceError` that names the part; other parts are read, and this
 *   one when the server tells the truth again
 */
describe('a part of a streamed scene whose server sends', () => {
  /** Files of a SOG. */
  const SOG_PARTS = { lied: 1, other: 2 };
  let sogFiles: Readonly<Record<string, Uint8Array<ArrayBuffer>>>;
  let rad: Uint8Array<ArrayBuffer>;
  let radParts: { readonly lied: number; readonly other: number };
  let bricks: Uint8Array<ArrayBuffer>;
  /** What parts hold, read from memory. */
  let sogContents: Contents;
  let radContents: Contents;
  let brickContents: Contents;
  beforeAll(async () => {
    const set = randomSplats({ count: 6000, seed: 4, shDegree: 1, logScales: [-6, -4] });
    const sog = await streamedSog({ set, filesOfLevel: [3, 1], leafCount: 3 });
    sogFiles = streamedSogFiles(sog);
    const dropped = droppedFiles(streamedSogFiles(sog, 'scene/'));
    sogContents = await contentsOf(await leafParts(openLeaves(knownSource(dropped)), SOG_PARTS));
    rad = radBytes(randomNodes(16_000, 1, true, 1, 0.4), { degree: 1, chunkSize: 3000 });
    const radScene = (await openRad(knownSource(new Blob([rad]))))!;
    radParts = { lied: radScene.leaves[1].levels[0].file, other: 0 };
    radContents = await contentsOf(await leafParts(Promise.resolve(radScene), radParts));
    bricks = await write(randomSplats({ count: 8300, seed: 4, shDegree: 2, logScales: [-6, -4] }), {});
    brickContents = await contentsOf(await brickParts(await openBricks(knownSource(bricks))));
  });

  test.each(Object.keys(LIES))('%s is told: an image of a SOG', async (kind) => {
    let lie: Lie | null = null;
    const address = await serve(sogFiles, (path) => (path === '0_1/means_l.webp' ? lie : null));
    const opening = openLeaves(knownSource(`${address}lod-meta.json`), { request: REQUEST });
    await expectHonesty(await leafParts(opening, SOG_PARTS), sogContents, (next) => (lie = next), kind);
  });

  test.each(Object.keys(LIES))('%s is told: the metadata of a file of a SOG', async (kind) => {
    let lie: Lie | null = null;
    const address = await serve(sogFiles, (path) => (path === '0_1/meta.json' ? lie : null));
    const opening = openLeaves(knownSource(`${address}lod-meta.json`), { request: REQUEST });
    await expectHonesty(await leafParts(opening, SOG_PARTS), sogContents, (next) => (lie = next), kind);
  });

  test.each(Object.keys(LIES))('%s is told: a chunk of a .rad', async (kind) => {
    let lie: Lie | null = null;
    /** Where the part begins that is asked for first. */
    let liedFrom: number | null = null;
    const address = await serve({ 'a.rad': rad }, (_, from) => {
      if (lie) liedFrom ??= from;
      return from === liedFrom ? lie : null;
    });
    const opening = openRad(knownSource(`${address}a.rad`), { request: REQUEST });
    await expectHonesty(await leafParts(opening, radParts), radContents, (next) => (lie = next), kind);
    expect(liedFrom).toBeGreaterThan(0);
  });

  test.each(Object.keys(LIES))('%s is told: a brick', async (kind) => {
    let lie: Lie | null = null;
    const asked: number[] = [];
    const lied = (await lowestOf(await openBricks(knownSource(bricks)))).at(-1)!;
    const address = await serve({ 'a.bricks': bricks }, (_, from) => {
      asked.push(from);
      return from >= lied.offset ? lie : null;
    });
    const scene = await openBricks(knownSource(`${address}a.bricks`), { request: REQUEST });
    await expectHonesty(await brickParts(scene), brickContents, (next) => (lie = next), kind);
    expect(asked).toContain(lied.offset);
  });
});
