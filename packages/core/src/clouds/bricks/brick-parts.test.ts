import { createServer, type Server, type ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import { afterEach, beforeAll, beforeEach, describe, expect, onTestFinished, test, vi } from 'vitest';
import type { BrickScene } from '../../data/bricks/brick.ts';
import { brickSceneOf } from '../../data/bricks/make-bricks.ts';
import { SplatFileError, SplatSourceError, WebSplatterError } from '../../data/errors.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { nextTask } from '../../data/turns.ts';
import { openBricks } from '../../io/formats/bricks/open-bricks.ts';
import { write } from '../../io/formats/bricks/write-bricks.ts';
import { knownSource } from '../../io/sources/known-source.ts';
import { waitMs } from '../../io/sources/wait-ms.ts';
import { FakeBrickPool } from '../../testing/fake-brick-pool.ts';
import { fuzz } from '../../testing/fuzz.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { signalOf } from '../../testing/signal.ts';
import { SceneStream } from '../stream/scene-stream.ts';
import { BrickParts } from './brick-parts.ts';
import type { BrickPool } from './brick-pool.ts';

vi.mock('../../io/sources/wait-ms.ts');

/** Sees all of a scene, in full. */
const SIGHT = {
  cut: { camera: [0, 0, 2], squaredPerDistance: 1e-9, leastSquared: 1e-12, margin: 0 },
  squaredShift: 1,
  sides: [],
} as const;

type Answer = (response: ServerResponse, start: number, end: number) => void;

let content: Uint8Array;
let answer: Answer;
let requests: number;
/** The parts of these. */
let asked: { readonly start: number; readonly end: number }[];
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
  asked = [];
  vi.mocked(waitMs).mockReset().mockResolvedValue();
  server = createServer((request, response) => {
    const [, start, last] = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? '') ?? [];
    const part = { start: Number(start), end: Math.min(Number(last) + 1, content.length) };
    requests++;
    asked.push(part);
    answer(response, part.start, part.end);
  });
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  url = `http://127.0.0.1:${(server.address() as AddressInfo).port}/a.bricks`;
});

afterEach(() => {
  server.closeAllConnections();
  server.close();
});

async function begin(options = {}): Promise<{ scene: BrickScene; pool: FakeBrickPool; stream: SceneStream }> {
  const scene = await openBricks(knownSource(url, options), options);
  const pool = new FakeBrickPool();
  const root = pool.place(await scene.read(scene.root), scene.root, null);
  const stream = new SceneStream(new BrickParts(scene, pool as unknown as BrickPool, root));
  onTestFinished(() => stream.end());
  requests = 0;
  return { scene, pool, stream };
}

const look = (stream: SceneStream) => {
  stream.setSights(stream, [SIGHT], async () => {});
  stream.onFrame();
};

test('asks for little before there is a picture, for the rest once there is, and for no byte twice', async () => {
  const { scene, stream } = await begin();
  stream.setSights(stream, [SIGHT], async () => {});
  await expect.poll(() => stream.report().fetching).toBe(0);
  const bytes = () => asked.reduce((sum, { start, end }) => sum + end - start, 0);
  expect(bytes()).toBeLessThan(2e6);
  expect(stream.report().residentBricks).toBeGreaterThan(10);
  expect(stream.report().isComplete).toBe(false);
  expect(stream.complete).not.toBeNull();
  stream.onFrame();
  await stream.complete;
  expect(stream.report()).toMatchObject({ residentBricks: scene.brickCount, error: null });
  expect(bytes()).toBe(content.length);
});

test('shows all of its scene coarsely, by few bytes that views need not ask for again', async () => {
  const { scene, stream } = await begin();
  const bytes = () => asked.reduce((sum, { start, end }) => sum + end - start, 0);
  const before = bytes();
  const coarse = await stream.coarse();
  expect(coarse.count).toBeGreaterThan(9000);
  expect(coarse.words!.length).toBe(coarse.count * GEOMETRY_WORDS[coarse.precision]);
  expect(bytes() - before).toBeLessThan(2e6);
  const asking = requests;
  expect(await stream.coarse()).toBe(coarse);
  expect(requests).toBe(asking);
  look(stream);
  await stream.complete;
  expect(stream.report()).toMatchObject({ residentBricks: scene.brickCount, error: null });
  expect(bytes()).toBe(content.length);
});

test('shares bricks that are being read, even if one of those who ask calls that off', async () => {
  const { scene, stream } = await begin();
  const reason = new Error('enough');
  const ending = new AbortController();
  const held = signalOf();
  answer = async (...args) => {
    await held.when;
    sendPart(...args);
  };
  const off = stream.coarse(ending.signal).catch((error: unknown) => error);
  look(stream);
  await expect.poll(() => requests).toBeGreaterThan(0);
  const coarse = stream.coarse();
  ending.abort(reason);
  held.give();
  expect(await off).toBe(reason);
  expect((await coarse).count).toBeGreaterThan(9000);
  await stream.complete;
  expect(stream.report()).toMatchObject({ residentBricks: scene.brickCount, error: null });
});

test('asks for bricks that lie next to each other together', async () => {
  const { scene, stream } = await begin();
  look(stream);
  await stream.complete;
  expect(stream.report()).toMatchObject({ residentBricks: scene.brickCount, error: null });
  expect(scene.brickCount).toBeGreaterThan(39);
  expect(requests).toBeLessThan(scene.brickCount / 4);
});

describe('while a view draws frame after frame', () => {
  const FRAME_MS = 16;
  const whole = brickSceneOf(randomSplats({ count: 40_000, seed: 2, shDegree: 0 }));

  /** Bricks from this number on come once `give` was called. */
  async function follow(held = 0) {
    vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout', 'performance'] });
    onTestFinished(() => void vi.useRealTimers());
    const pool = new FakeBrickPool();
    const root = pool.place(await whole.read(whole.root), whole.root, null);
    const { when, give } = signalOf();
    const read: BrickScene['read'] = async (address) => {
      if (address.number >= held) await when;
      return whole.read(address);
    };
    const stream = new SceneStream(new BrickParts({ ...whole, read }, pool as unknown as BrickPool, root));
    onTestFinished(() => stream.end());
    stream.onFrame();
    const redraw = vi.fn(async () => {});
    let frames = 0;
    /** @param step how far the camera has moved since the last frame. */
    const draw = async (step = 0) => {
      vi.advanceTimersByTime(FRAME_MS);
      const [x, y, z] = SIGHT.cut.camera;
      const camera = [x + step * frames++, y, z] as const;
      stream.setSights(stream, [{ ...SIGHT, cut: { ...SIGHT.cut, camera } }], redraw);
      await nextTask();
    };
    return { pool, stream, redraw, draw, give };
  }

  test('places more after each as long as that delays none, and the rest when it rests', async () => {
    const { pool, stream, redraw, draw, give } = await follow();
    await draw();
    await draw();
    give();
    await nextTask();
    expect(stream.report().fetching).toBeGreaterThan(0);
    expect(pool.bricks).toHaveLength(1);
    for (const placed of [2, 10, Math.min(26, whole.brickCount)]) {
      await draw();
      expect(pool.bricks).toHaveLength(placed);
    }
    expect(redraw).not.toHaveBeenCalled();
    expect(stream.complete).not.toBeNull();
    vi.advanceTimersByTime(10 * FRAME_MS);
    await stream.complete;
    expect(pool.bricks).toHaveLength(whole.brickCount);
    expect(redraw).toHaveBeenCalled();
  });

  test('places one after each of a moving view where the device takes half of the time between frames for it', async () => {
    const { pool, draw, give } = await follow();
    const STEP = 1e-6;
    await draw(STEP);
    await draw(STEP);
    give();
    await nextTask();
    let drawn = pool.bricks.length;
    pool.whenDone = async () => {
      vi.advanceTimersByTime((pool.bricks.length - drawn) * (FRAME_MS / 2));
      drawn = pool.bricks.length;
    };
    for (const placed of [2, 3, 4, 5]) {
      await draw(STEP);
      expect(pool.bricks).toHaveLength(placed);
    }
  });

  test('is complete once what came last has been drawn', async () => {
    const { pool, stream, redraw, draw, give } = await follow();
    await draw();
    await draw();
    give();
    while (pool.bricks.length < whole.brickCount) await draw();
    redraw.mockClear();
    expect(stream.report()).toMatchObject({ fetching: 0, missingBricks: 0 });
    expect(stream.complete).not.toBeNull();
    vi.advanceTimersByTime(10 * FRAME_MS);
    expect(redraw).toHaveBeenCalledOnce();
    expect(stream.complete).toBeNull();
  });

  // Timers drop parts of milliseconds: they end just before the view is at rest, or while that is asked.
  test('loses nothing where its timer ends a little early', async () => {
    const TICK_MS = 0.02;
    for (let early = 0; early < 20; early++) {
      const { pool, stream, draw, give } = await follow();
      await draw();
      await draw();
      // These come after the last frame.
      give();
      await nextTask();
      const exact = performance.now.bind(performance);
      let calls = 0;
      const clock = vi
        .spyOn(performance, 'now')
        .mockImplementation(() => exact() + TICK_MS * (calls++ - early));
      for (let ms = 0; ms < 200; ms++) {
        calls = 0;
        vi.advanceTimersByTime(1);
        await nextTask();
      }
      clock.mockRestore();
      expect([early, pool.bricks.length, stream.complete]).toEqual([early, whole.brickCount, null]);
      stream.end();
      vi.useRealTimers();
    }
  });

  test('takes no frame that it has asked for as one of the view', async () => {
    const { pool, stream, redraw, give } = await follow();
    give();
    redraw.mockImplementation(async () => stream.setSights(stream, [SIGHT], redraw));
    stream.setSights(stream, [SIGHT], redraw);
    await stream.complete;
    expect(pool.bricks).toHaveLength(whole.brickCount);
    expect(vi.getTimerCount()).toBe(0);
  });
});

test('lists the same after bricks were placed as one that begins then', async () => {
  const whole = brickSceneOf(randomSplats({ count: 80_000, seed: 2, shDegree: 0 }));
  const sights = { sights: [SIGHT], predicted: [], areCurrent: true };
  const events = { onBytes: () => {}, onProgress: () => {}, onSettled: () => {}, onError: () => {} };
  for (const slots of [undefined, { lowest: 9, upper: 4 }]) {
    const pool = new FakeBrickPool(slots) as unknown as BrickPool;
    const root = pool.place(await whole.read(whole.root), whole.root, null);
    const parts = new BrickParts(whole, pool, root);
    let missing = parts.plan(sights);
    for (let upload = 0; upload < 12; upload++) {
      const fitting = missing.filter(({ fits }) => fits);
      for (const part of [fitting[0], ...fitting.slice(-2)])
        if (part) await parts.fetch(part, new AbortController().signal, events);
      parts.upload({ parts: 3, ms: 1000 }, events);
      missing = parts.plan(sights);
      const fresh = new BrickParts(whole, pool, root);
      expect(missing).toEqual(fresh.plan(sights));
      const { missingBricks, refusedBricks, isComplete } = fresh.report();
      expect(parts.report()).toMatchObject({ missingBricks, refusedBricks, isComplete });
    }
    expect(missing.some(({ fits }) => fits)).toBe(false);
    const lowest = pool.bricks.filter(({ level }) => level === 0);
    expect(lowest).toHaveLength(slots ? slots.lowest : 20);
  }
});

test('places fewer if merging took long the last time, so that both keep the limit', async () => {
  vi.useFakeTimers({ toFake: ['performance'] });
  onTestFinished(() => void vi.useRealTimers());
  const whole = brickSceneOf(randomSplats({ count: 80_000, seed: 2, shDegree: 0 }));
  const fake = new FakeBrickPool();
  const pool = fake as unknown as BrickPool;
  const parts = new BrickParts(whole, pool, pool.place(await whole.read(whole.root), whole.root, null));
  const events = { onBytes: () => {}, onProgress: () => {}, onSettled: () => {}, onError: () => {} };
  const sights = { sights: [SIGHT], predicted: [], areCurrent: true };
  const fetchAll = async () => {
    for (const part of parts.plan(sights)) await parts.fetch(part, new AbortController().signal, events);
  };
  const limit = { parts: Number.POSITIVE_INFINITY, ms: 4 };
  for (const below of [1, 2]) {
    await fetchAll();
    expect(parts.upload(limit, events)).toBe(below);
  }
  await fetchAll();
  const place = fake.place.bind(fake);
  vi.spyOn(fake, 'place').mockImplementation((...args) => {
    vi.advanceTimersByTime(1);
    return place(...args);
  });
  vi.spyOn(fake, 'merge').mockImplementation(() => void vi.advanceTimersByTime(2));
  expect([0, 1].map(() => parts.upload(limit, events))).toEqual([4, 2]);
});

test('tells of a brick that contradicts the others, keeps what is there, and goes on when called', async () => {
  const whole = brickSceneOf(randomSplats({ count: 40_000, seed: 2, shDegree: 0 }));
  const pool = new FakeBrickPool();
  const root = pool.place(await whole.read(whole.root), whole.root, null);
  const error = new SplatFileError('damaged', 'a scene', 'Brick 2 has 3 cells, and 4 are to be there.');
  const place = vi.spyOn(pool, 'place').mockImplementation(() => {
    throw error;
  });
  const stream = new SceneStream(new BrickParts(whole, pool as unknown as BrickPool, root));
  onTestFinished(() => stream.end());
  look(stream);
  await stream.complete;
  expect(stream.report()).toMatchObject({ error, residentBricks: 1, fetching: 0, isComplete: false });
  place.mockRestore();
  stream.retry();
  await stream.complete;
  expect(stream.report()).toMatchObject({ error: null, residentBricks: whole.brickCount, isComplete: true });
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

test('comes through what servers do, and shows the same in the end', { tags: 'deeper' }, async () => {
  const good = await begin();
  look(good.stream);
  await good.stream.complete;
  await fuzz({ few: 3, many: 20 }, async (choices) => {
    answer = sendPart;
    const { pool, stream } = await begin({ request: { idleTimeoutMs: 40, maxRetries: 1 } });
    const range = (start: number, end: number) => ({
      etag: '"1"',
      'content-range': `bytes ${start}-${end - 1}/${content.length}`,
    });
    const wrongBytes = content.slice();
    for (let i = 0; i < content.length / 10_000; i++)
      wrongBytes[choices.below(content.length)] ^= 1 << choices.below(8);
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
