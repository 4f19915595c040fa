import { createServer, type Server, type ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import { afterEach, beforeAll, beforeEach, expect, onTestFinished, test, vi } from 'vitest';
import type { Brick, BrickAddress, BrickScene } from '../../data/bricks/brick.ts';
import { SplatSourceError, WebSplatterError } from '../../data/errors.ts';
import { openBricks } from '../../io/formats/bricks/open-bricks.ts';
import { write } from '../../io/formats/bricks/write-bricks.ts';
import { waitMs } from '../../io/sources/wait-ms.ts';
import { fuzz } from '../../testing/fuzz.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import type { BrickPool, PlacedBrick, PlacedCell } from './brick-pool.ts';
import { BrickStream } from './brick-stream.ts';

vi.mock('../../io/sources/wait-ms.ts');

/** Sees all of a scene, in full. */
const SIGHT = {
  cut: { camera: [0, 0, 2], squaredPerDistance: 1e-9, leastSquared: 1e-12, margin: 0 },
  squaredShift: 1,
  sides: [],
} as const;

/** Room for all bricks, without a GPU. */
class Pool {
  readonly slots = { lowest: 1000, upper: 1000 };
  readonly bricks: PlacedBrick[] = [];
  readonly contents: Brick[] = [];

  freeSlots(): number {
    return this.slots.lowest - this.bricks.length;
  }

  place(brick: Brick, address: BrickAddress, above: PlacedCell | null): PlacedBrick {
    const placed: PlacedBrick & { cells: PlacedCell[] } = { address, ...brick, slot: 0, cells: [], above };
    placed.cells = brick.cells.map((cell) => ({ ...cell, brick: placed, cell: 0, below: null }));
    if (above) above.below = placed;
    this.bricks.push(placed);
    this.contents[address.number] = brick;
    return placed;
  }
}

type Answer = (response: ServerResponse, start: number, end: number) => void;

let content: Uint8Array;
let answer: Answer;
let requests: number;
let server: Server;
let url: string;

const sendPart = (response: ServerResponse, start: number, end: number, etag = '"1"', from = content) => {
  const part = from.subarray(start, end);
  response.writeHead(206, { etag, 'content-range': `bytes ${start}-${end - 1}/${content.length}` });
  response.end(part);
};

beforeAll(async () => {
  content = await write(randomSplats({ count: 150_000, seed: 2, shDegree: 0, logScales: [-7, -4] }), {});
});

beforeEach(async () => {
  answer = sendPart;
  requests = 0;
  vi.mocked(waitMs).mockReset().mockResolvedValue();
  server = createServer((request, response) => {
    const [, start, last] = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? '') ?? [];
    requests++;
    answer(response, Number(start), Math.min(Number(last) + 1, content.length));
  });
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  url = `http://127.0.0.1:${(server.address() as AddressInfo).port}/a.bricks`;
});

afterEach(() => {
  server.closeAllConnections();
  server.close();
});

async function begin(options = {}): Promise<{ scene: BrickScene; pool: Pool; stream: BrickStream }> {
  const scene = await openBricks(url, options);
  const pool = new Pool();
  const root = pool.place(await scene.read(scene.root), scene.root, null);
  const stream = new BrickStream(scene, pool as unknown as BrickPool, root);
  onTestFinished(() => stream.end());
  requests = 0;
  return { scene, pool, stream };
}

const look = (stream: BrickStream) => stream.see(stream, [SIGHT], async () => {});

test('asks for bricks that lie next to each other together', async () => {
  const { scene, stream } = await begin();
  look(stream);
  await stream.complete;
  expect(stream.report()).toMatchObject({ residentBricks: scene.brickCount, error: null });
  expect(scene.brickCount).toBeGreaterThan(39);
  expect(requests).toBeLessThan(scene.brickCount / 4);
});

test('keeps what is there while its server is gone, and goes on when the browser is online', async () => {
  const page = new EventTarget();
  vi.stubGlobal('addEventListener', page.addEventListener.bind(page));
  onTestFinished(() => void vi.unstubAllGlobals());
  const { scene, stream } = await begin();
  let left = 2;
  answer = (response, ...part) => (left-- > 0 ? sendPart(response, ...part) : response.destroy());
  look(stream);
  await stream.complete;
  const { error, residentBricks } = stream.report();
  expect(error).toBeInstanceOf(SplatSourceError);
  expect(residentBricks).toBeGreaterThan(1);
  const before = requests;
  look(stream);
  expect(stream.complete).toBeNull();
  expect(requests).toBe(before);
  answer = sendPart;
  page.dispatchEvent(new Event('online'));
  await stream.complete;
  expect(stream.report()).toMatchObject({ residentBricks: scene.brickCount, error: null });
});

test('tells that its file has changed, as often as it is asked', async () => {
  const { stream } = await begin();
  answer = (response, start, end) => sendPart(response, start, end, '"2"');
  // Those that came with the beginning of the file.
  const residentBricks = 3;
  for (const go of [() => look(stream), () => stream.retry()]) {
    requests = 0;
    go();
    await stream.complete;
    expect(stream.report()).toMatchObject({ residentBricks, fetching: 0 });
    expect(stream.report().error?.message).toContain('has changed on its server');
    expect(requests).toBeLessThanOrEqual(4);
  }
});

test('comes through what servers do, and shows the same in the end', async () => {
  const good = await begin();
  look(good.stream);
  await good.stream.complete;
  await fuzz({ few: 3, many: 40 }, async (choices) => {
    answer = sendPart;
    const { pool, stream } = await begin({ request: { idleTimeoutMs: 40, maxRetries: 1 } });
    const range = (start: number, end: number) => ({
      etag: '"1"',
      'content-range': `bytes ${start}-${end - 1}/${content.length}`,
    });
    const wrongBytes = content.map((byte) => byte ^ (choices.isTrue(1e-4) ? 1 << choices.below(8) : 0));
    const faults: Answer[] = [
      sendPart,
      (response) => response.destroy(),
      (response) => response.writeHead(404).end(),
      (response) => response.writeHead(500).end(),
      (response) => response.writeHead(503, { 'retry-after': choices.of(['1', '31', 'soon']) }).end(),
      (response, ...part) => sendPart(response, ...part, choices.of(['"2"', 'W/"1"'])),
      (response, ...part) => sendPart(response, ...part, '"1"', wrongBytes),
      (response, start, end) => sendPart(response, start + 1, end),
      (response, start, end) => sendPart(response, start, start + 1 + choices.below(end - start)),
      (response) => response.writeHead(200, { etag: '"1"' }).end(content),
      // Never ends, after a few bytes or none.
      (response, start, end) => {
        response.writeHead(206, range(start, end));
        response.write(content.subarray(start, start + choices.below(end - start)));
      },
      (response, start, end) => {
        response.writeHead(206, range(start, end));
        response.write(content.subarray(start, start + choices.below(end - start)), () => response.destroy());
      },
      (response, start, end) => {
        response.writeHead(206, range(start, end));
        let at = start;
        const drip = setInterval(() => response.write(content.subarray(at, ++at)), 1);
        response.on('close', () => clearInterval(drip));
      },
    ];
    answer = (...request) => (requests < 60 ? choices.of(faults)(...request) : sendPart(...request));
    look(stream);
    let resident = 1;
    for (;;) {
      await stream.complete;
      const { residentBricks, error, fetching } = stream.report();
      expect(residentBricks).toBeGreaterThanOrEqual(resident);
      resident = residentBricks;
      expect(fetching).toBe(0);
      if (!error) break;
      expect(error).toBeInstanceOf(WebSplatterError);
      stream.retry();
    }
    expect(pool.contents).toEqual(good.pool.contents);
  });
});
