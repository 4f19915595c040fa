import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import type { Brick, BrickScene } from '../../data/bricks/brick.ts';
import type { LeafScene, SplatCells } from '../../data/bricks/leaf-scene.ts';
import { DestroyedError, SplatFileError, SplatSourceError, WebSplatterError } from '../../data/errors.ts';
import { fakeWorker } from '../../testing/fake-worker.ts';
import { fileErrorOf } from '../../testing/file-error-of.ts';
import { piecesOf } from '../../testing/pieces-of.ts';
import { radBytes, randomNodes } from '../../testing/rad-fixture.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { signalOf } from '../../testing/signal.ts';
import { droppedFiles } from '../../testing/sog-fixture.ts';
import { streamedSog, streamedSogFiles } from '../../testing/streamed-sog-fixture.ts';
import { brickHeaderBytes, FILE_HEADER_BYTES } from '../formats/bricks/bricks-layout.ts';
import { openBricks } from '../formats/bricks/open-bricks.ts';
import { write } from '../formats/bricks/write-bricks.ts';
import { openRad } from '../formats/rad/open-rad.ts';
import { SCENE_TASKS, WAITING_TASKS } from '../formats/scene-tasks.ts';
import { openLeaves } from '../formats/sog/open-leaves.ts';
import { type ServerPort, serve } from '../remote.ts';
import { knownSource } from '../sources/known-source.ts';

const FakeWorker = fakeWorker(() => SCENE_TASKS, WAITING_TASKS);
const written = write(randomSplats({ count: 4200, seed: 3, shDegree: 2 }), {});

beforeEach(() => {
  vi.spyOn(console, 'warn').mockImplementation(() => {});
  FakeWorker.behaviour = 'works';
  FakeWorker.started = [];
  FakeWorker.requests = [];
  vi.stubGlobal('Worker', FakeWorker);
  vi.stubGlobal('navigator', { hardwareConcurrency: 2 });
});

afterEach(() => {
  vi.restoreAllMocks();
  vi.unstubAllGlobals();
  for (const worker of FakeWorker.started) expect(worker.isTerminated).toBe(true);
});

async function open(bytes?: Uint8Array<ArrayBuffer>): Promise<BrickScene> {
  return openBricks(knownSource(bytes ?? (await written), { name: 'a.bricks' }));
}

async function allBricks(scene: BrickScene): Promise<Brick[]> {
  const bricks = [await scene.read(scene.root)];
  for (const { cells } of bricks)
    bricks.push(...(await Promise.all(cells.flatMap(({ child }) => (child ? scene.read(child) : [])))));
  return bricks;
}

describe('bricks that a worker decodes', () => {
  test('are those that the calling thread decodes, bit for bit', async () => {
    const scene = await open();
    const bricks = await allBricks(scene);
    scene.end();
    expect(bricks).toHaveLength(scene.brickCount);
    expect(FakeWorker.requests).toHaveLength(scene.brickCount);
    expect(FakeWorker.started).toHaveLength(1);
    vi.stubGlobal('Worker', undefined);
    expect(await allBricks(await open())).toEqual(bricks);
    expect(FakeWorker.requests).toHaveLength(scene.brickCount);
  });

  test('are spread over no more workers than cores are left, and no more than six', async () => {
    for (const [cores, workers] of [
      [1, 1],
      [2, 1],
      [3, 2],
      [64, 6],
    ]) {
      vi.stubGlobal('navigator', { hardwareConcurrency: cores });
      FakeWorker.started = [];
      const scene = await open();
      await scene.read(scene.root);
      expect(FakeWorker.started).toHaveLength(1);
      const reads = Array.from({ length: 8 }, () => scene.read(scene.root));
      const bricks = await Promise.all(reads);
      for (const brick of bricks) expect(brick).toEqual(bricks[0]);
      expect(FakeWorker.started).toHaveLength(workers);
      scene.end();
      expect(FakeWorker.started.filter(({ isTerminated }) => isTerminated)).toHaveLength(workers);
    }
  });

  test.each(['throws', 'does not start'] as const)(
    'are decoded on the calling thread where a worker %s',
    async (behaviour) => {
      FakeWorker.behaviour = behaviour;
      const scene = await open();
      expect(await allBricks(scene)).toHaveLength(scene.brickCount);
      expect(FakeWorker.requests).toHaveLength(0);
      scene.end();
    },
  );

  test('leave the memory that they are read from as it was', async () => {
    const bytes = (await written).slice();
    const scene = await open(bytes);
    await allBricks(scene);
    scene.end();
    expect(bytes).toEqual(await written);
  });

  test('fail as they do on the calling thread', async () => {
    const bytes = (await written).slice();
    bytes[FILE_HEADER_BYTES + brickHeaderBytes(1, 1) + 20] ^= 255;
    const scene = await open(bytes);
    const error = await fileErrorOf(scene.read(scene.root));
    scene.end();
    vi.stubGlobal('Worker', undefined);
    const other = await open(bytes);
    const { code, file, place, message } = await fileErrorOf(other.read(other.root));
    expect(error).toMatchObject({ code, file, place, message });
    expect(error).toBeInstanceOf(SplatFileError);
  });

  test('are given up at once, and the next ones come', async () => {
    const scene = await open();
    const root = await scene.read(scene.root);
    FakeWorker.behaviour = 'is busy';
    const ending = new AbortController();
    const reading = scene.read(scene.root, ending.signal);
    await expect.poll(() => FakeWorker.requests.length).toBe(2);
    ending.abort('not needed');
    await expect(reading).rejects.toBe('not needed');
    expect(FakeWorker.requests.at(-1)).toEqual({ drop: 2 });
    FakeWorker.behaviour = 'works';
    expect(await scene.read(scene.root)).toEqual(root);
    scene.end();
  });

  /**
   * @fault Files: a worker of a scene that streams dies
   * @consequence `cloud.stream.report().error` is a `WebSplatterError` `worker-failed`; another worker
   *   decodes the next part
   */
  test('fail by name where the worker dies, and another one decodes the next', async () => {
    const scene = await open();
    await scene.read(scene.root);
    FakeWorker.behaviour = 'dies';
    const error = await scene.read(scene.root).catch((reason) => reason);
    expect(error).toBeInstanceOf(WebSplatterError);
    expect(error).toMatchObject({
      code: 'worker-failed',
      message: 'a.bricks: the worker of the scene stopped: out of memory.',
    });
    FakeWorker.behaviour = 'works';
    await scene.read(scene.root);
    expect(FakeWorker.started.map(({ isTerminated }) => isTerminated)).toEqual([true, false]);
    scene.end();
  });

  test('come no more after the end of their scene', async () => {
    const scene = await open();
    const reading = scene.read(scene.root);
    // Awaited after the end, which rejects it at once.
    reading.catch(() => {});
    scene.end();
    scene.end();
    await expect(reading).rejects.toThrow(DestroyedError);
    await expect(scene.read(scene.root)).rejects.toThrow('a.bricks');
  });

  test('have no worker where there is no scene', async () => {
    await expect(open(new Uint8Array(300))).rejects.toThrow(SplatFileError);
    await expect(
      openBricks(knownSource(await written), { signal: AbortSignal.abort(new Error('enough')) }),
    ).rejects.toThrow('enough');
    await expect.poll(() => FakeWorker.started.every(({ isTerminated }) => isTerminated)).toBe(true);
  });
});

describe('bricks that workers fetch', () => {
  const large = write(randomSplats({ count: 30_000, seed: 4, shDegree: 1 }), {});
  /** Answers to requests for bytes from `start` to before `end`. */
  let answer: (bytes: Uint8Array<ArrayBuffer>, start: number, signal: AbortSignal) => BodyInit;
  let tag: string;
  let ranges: string[];

  beforeEach(async () => {
    answer = (bytes) => bytes;
    tag = '"1"';
    ranges = [];
    const file = await large;
    vi.stubGlobal(
      'fetch',
      async (_: string, { headers, signal }: { headers: { range: string }; signal: AbortSignal }) => {
        const [start, last] = headers.range.slice('bytes='.length).split('-').map(Number);
        ranges.push(headers.range);
        const bytes = file.slice(start, last + 1);
        const range = `bytes ${start}-${start + bytes.length - 1}/${file.length}`;
        return new Response(answer(bytes, start, signal), {
          status: 206,
          headers: { etag: tag, 'content-range': range },
        });
      },
    );
  });

  /** The scene, and addresses of adjacent bricks behind the first bytes, which the page itself fetches. */
  async function opened() {
    const scene = await openBricks(knownSource('https://a.example/a.bricks'));
    const root = await scene.read(scene.root);
    const { cells } = await scene.read(root.cells[0].child!);
    const children = cells.flatMap(({ child }) => child ?? []);
    const addresses = children.filter(({ offset }) => offset >= 1 << 17).slice(0, 5);
    expect(addresses).toHaveLength(5);
    ranges = [];
    return { scene, addresses };
  }

  const tasks = () => FakeWorker.requests.map((request) => 'task' in request && request.task);

  test('are those of the same file in memory, those that adjoin by one request', async () => {
    const { scene, addresses } = await opened();
    const bricks = await Promise.all(addresses.map((address) => scene.read(address)));
    expect(tasks()).toEqual(['decodeBrick', 'decodeBrick', 'fetchBricks']);
    const { offset, bytes } = addresses[4];
    expect(ranges).toEqual([`bytes=${addresses[0].offset}-${offset + bytes - 1}`]);
    scene.end();
    vi.stubGlobal('Worker', undefined);
    const inMemory = await open(await large);
    for (const [i, { number, offset, bytes }] of addresses.entries())
      expect(bricks[i]).toEqual(await inMemory.read({ number, offset, bytes }));
    const here = await opened();
    expect(await Promise.all(here.addresses.map((address) => here.scene.read(address)))).toEqual(bricks);
    expect(ranges).toHaveLength(1);
  });

  test('come over one by one, as soon as their bytes are there', async () => {
    const { scene, addresses } = await opened();
    const { when: finished, give: finish } = signalOf();
    answer = (bytes) =>
      new ReadableStream({
        async start(controller) {
          controller.enqueue(bytes.subarray(0, addresses[0].bytes + 1));
          await finished;
          controller.enqueue(bytes.subarray(addresses[0].bytes + 1));
          controller.close();
        },
      });
    const [first, ...others] = addresses.map((address) => scene.read(address));
    expect((await first).level).toBe(0);
    finish();
    for (const brick of await Promise.all(others)) expect(brick.level).toBe(0);
    expect(ranges).toHaveLength(1);
    scene.end();
  });

  test('end their request once none of them is needed, and not before', async () => {
    const { scene, addresses } = await opened();
    const { when: begun, give: begin } = signalOf();
    const { when: closed, give: close } = signalOf();
    answer = (_, __, signal) => {
      signal.addEventListener('abort', close);
      begin();
      return new ReadableStream();
    };
    const enders = addresses.map(() => new AbortController());
    const reads = addresses.map((address, i) => scene.read(address, enders[i].signal));
    const ends = Promise.allSettled(reads);
    await begun;
    enders[0].abort('early');
    await expect(reads[0]).rejects.toBe('early');
    expect(FakeWorker.requests.filter((request) => 'drop' in request)).toHaveLength(0);
    for (const ender of enders.slice(1)) ender.abort('late');
    await ends;
    await closed;
    scene.end();
  });

  test.each(['works', 'does not start'] as const)(
    'fail alone if they are damaged, where a worker %s',
    async (behaviour) => {
      FakeWorker.behaviour = behaviour;
      const { scene, addresses } = await opened();
      const [left, damaged, ...others] = addresses;
      answer = (bytes, start) => {
        for (const { offset, bytes: count } of [left, damaged]) bytes[offset - start + count - 9] ^= 255;
        return bytes;
      };
      const ender = new AbortController();
      const wanted = scene.read(left, ender.signal);
      const read = scene.read(damaged);
      const intact = others.map((address) => scene.read(address));
      ender.abort('not needed');
      await expect(wanted).rejects.toBe('not needed');
      const error = await fileErrorOf(read);
      expect(error).toMatchObject({ code: 'damaged' });
      expect(error.message).toContain(`brick ${damaged.number}`);
      for (const brick of await Promise.all(intact)) expect(brick.level).toBe(0);
      scene.end();
    },
  );

  test('fail if the file has changed on its server', async () => {
    const { scene, addresses } = await opened();
    tag = '"2"';
    const error = await scene.read(addresses[1]).catch((reason) => reason);
    expect(error).toBeInstanceOf(SplatSourceError);
    expect(error.message).toContain('has changed on its server');
    scene.end();
  });

  test('fail by name where the worker dies, and another one fetches the next', async () => {
    const { scene, addresses } = await opened();
    FakeWorker.behaviour = 'dies';
    const reads = await Promise.allSettled(addresses.map((address) => scene.read(address)));
    for (const read of reads) expect(read).toMatchObject({ reason: { code: 'worker-failed' } });
    FakeWorker.behaviour = 'works';
    expect((await scene.read(addresses[0])).level).toBe(0);
    scene.end();
  });
});

describe('leaves that workers pack', () => {
  const leafCount = 3;
  const sog = streamedSog({
    set: randomSplats({ count: 6000, seed: 5, shDegree: 1, logScales: [-6, -4] }),
    filesOfLevel: [leafCount, 1],
    leafCount,
  });
  const tree = radBytes(randomNodes(1000, 1, true, 1, 0.4), { degree: 1, chunkSize: 100, paletteSize: 50 });
  const openers: Readonly<Record<string, () => Promise<LeafScene | null>>> = {
    'a streamed SOG': async () => openLeaves(knownSource(droppedFiles(streamedSogFiles(await sog)))),
    'a .rad with a tree': () => openRad(knownSource(new Blob([tree]))),
  };
  const allPieces = async (scene: LeafScene) => {
    const pieces: SplatCells[][] = [];
    for (const leaf of scene.leaves)
      for (const level of leaf.levels) {
        const isInFile = leaf.above === undefined || level === leaf.levels[0];
        if (isInFile) pieces.push(await piecesOf(scene, leaf, level));
      }
    scene.end();
    return pieces;
  };

  test.each(Object.keys(openers))(
    'of %s are those that the calling thread packs, bit for bit',
    async (kind) => {
      const packed = await allPieces((await openers[kind]())!);
      expect(packed.flat().length).toBeGreaterThan(5);
      expect(FakeWorker.requests.length).toBeGreaterThan(5);
      expect(FakeWorker.started).toHaveLength(1);
      vi.stubGlobal('Worker', undefined);
      expect(await allPieces((await openers[kind]())!)).toEqual(packed);
    },
  );

  test('are fetched by workers where they lie at an address, and errors are as on the calling thread', async () => {
    const files = streamedSogFiles(await sog);
    const fetchFile = async (url: string) => {
      const bytes = files[new URL(url).pathname.slice(1)];
      return bytes ? new Response(bytes.slice()) : new Response(null, { status: 404 });
    };
    vi.stubGlobal('fetch', fetchFile);
    const open = async () => (await openLeaves(knownSource('https://a.example/lod-meta.json')))!;
    const scene = await open();
    let toldBytes = 0;
    await scene.read(0, undefined, (bytes) => {
      toldBytes += bytes;
    });
    const folder = (await sog).meta.filenames[0].replace('meta.json', '');
    const inFolder = Object.entries(files).filter(([path]) => path.startsWith(folder));
    const fileBytes = inFolder.reduce((sum, [, bytes]) => sum + bytes.length, 0);
    expect(toldBytes).toBe(fileBytes);
    expect(scene.fetchedBytes).toBe(fileBytes);
    expect(FakeWorker.requests).toMatchObject([{ task: 'fetchSogFile' }]);
    const packed = await allPieces(scene);
    expect(packed).toEqual(await allPieces((await openers['a streamed SOG']())!));
    delete files[`${folder}quats.webp`];
    const failed = await open();
    const error = await failed.read(0).catch((reason) => reason);
    failed.end();
    vi.stubGlobal('Worker', undefined);
    const here = await (await open()).read(0).catch((reason) => reason);
    expect(error).toBeInstanceOf(SplatSourceError);
    expect(error).toMatchObject({ message: here.message, status: 404 });
  });

  test('are packed by workers that start at once, those of one file by one', async () => {
    vi.stubGlobal('navigator', { hardwareConcurrency: 8 });
    const scene = (await openers['a streamed SOG']())!;
    await expect.poll(() => FakeWorker.started.length).toBe(6);
    const posted = FakeWorker.started.map((worker) => vi.spyOn(worker.page, 'postMessage'));
    const callsOf = () => posted.map(({ mock }) => mock.calls.length).sort((a, b) => b - a);
    const coarsest = await scene.read(leafCount);
    await Promise.all(scene.leaves.map((leaf) => piecesOf(coarsest, leaf, leaf.levels[1])));
    expect(callsOf()).toEqual([leafCount, 0, 0, 0, 0, 0]);
    const finest = scene.leaves.map(async (leaf) => {
      const [level] = leaf.levels;
      return piecesOf(scene, leaf, level);
    });
    await Promise.all(finest);
    expect(callsOf()).toEqual([leafCount, 1, 1, 1, 0, 0].toSorted((a, b) => b - a));
    scene.end();
  });

  test('of one file are packed by others, too, where many wait', async () => {
    vi.stubGlobal('navigator', { hardwareConcurrency: 8 });
    const scene = (await openers['a streamed SOG']())!;
    await expect.poll(() => FakeWorker.started.length).toBe(6);
    const posted = FakeWorker.started.map((worker) => vi.spyOn(worker.page, 'postMessage'));
    const coarsest = await scene.read(leafCount);
    const leaves = Array.from({ length: 9 }, (_, i) => scene.leaves[i % leafCount]);
    await Promise.all(leaves.map((leaf) => piecesOf(coarsest, leaf, leaf.levels[1])));
    expect(posted.map(({ mock }) => mock.calls.length).toSorted()).toEqual([0, 0, 0, 1, 4, 4]);
    scene.end();
  });
});

test('the worker does not begin with what is dropped', async () => {
  const replies: { kind: string; id?: number }[] = [];
  const port: ServerPort = { onmessage: null, postMessage: (reply) => replies.push(reply) };
  serve(SCENE_TASKS, port);
  const bytes = (await written).slice();
  const post = (data: unknown) => port.onmessage?.({ data } as MessageEvent);
  const file = { name: 'a.bricks', splatCount: 5000, shDegree: 2 };
  for (const id of [1, 2]) {
    const address = { number: 0, offset: 0, bytes: bytes.length };
    post({ task: 'decodeBrick', id, input: { file, address, bytes } });
  }
  post({ drop: 2 });
  await expect.poll(() => replies.length).toBe(3);
  // Neither are bricks; the first one was looked at.
  expect(replies).toMatchObject([
    { kind: 'ready' },
    { kind: 'error', id: 1, error: { className: 'SplatFileError' } },
    { kind: 'error', id: 2, error: { className: 'AbortError' } },
  ]);
});
