import { getEventListeners } from 'node:events';
import { queryObjects } from 'node:v8';
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterEach, expect, vi } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import type { LeafScene } from '../../data/bricks/leaf-scene.ts';
import { perspectiveCamera } from '../../data/camera/camera.ts';
import { SplatSourceError } from '../../data/errors.ts';
import { nextTask } from '../../data/turns.ts';
import { openLeaves } from '../../io/formats/sog/open-leaves.ts';
import { knownSource } from '../../io/sources/known-source.ts';
import {
  byLevel,
  expectOneLevel,
  expectShown,
  streamContext,
  watchCuts,
} from '../../testing/look-at-streams.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { streamedSog, streamedSogFiles } from '../../testing/streamed-sog-fixture.ts';
import type { SplatCloud } from '../splat-cloud.ts';
import { chunkBytes } from '../stream/chunk-pages.ts';
import { streamLeaves } from './stream-leaves.ts';

// Not a spy, which would keep all signals that it is given.
vi.mock('../../io/sources/wait-ms.ts', async () => ({
  waitMs: (await import('../../data/turns.ts')).nextTask,
}));

const FRAMES = 2500;
/** Of SwiftShader beside other work: a frame takes it 30 to 55 ms of processor time. */
const TIME_LIMIT_MS = 900_000;
/** Frames of a cloud, which then goes, whatever it is doing. */
const CLOUD_FRAMES = 25;
/** Frames after which the server is down until a cloud has failed to load. */
const DOWN_FRAMES = 250;
/** Frames between two looks at what the GPU draws. */
const LOOK_FRAMES = 25;
/** Frames that are submitted before one is waited for. */
const AT_ONCE = 4;
/** Objects that loads, fetches and frames could leave behind, and how many more there may be of each in the end. */
const COUNTED = [Promise, AbortSignal, Function];
const LEFT_OBJECTS = 30;
const SIZE = { widthPx: 32, heightPx: 24 };
const DETAILS = [{ maxErrorPx: 0.1 }, { maxErrorPx: 2 }, { maxSplats: 200 }, 'full'] as const;
const LEAVES = 6;
/** Chunks for the coarsest level of each leaf, for two finer ones, and those that a pool takes besides. */
const BUDGET_BYTES = (LEAVES + 2 + 4) * chunkBytes(0);

interface Shown {
  readonly cloud: SplatCloud;
  readonly scene: LeafScene;
}

afterEach(() => vi.unstubAllGlobals());

/** A server of these files, which fails at every fifth request or so until it is steady. */
function unsteadyServer(files: Readonly<Record<string, Uint8Array<ArrayBuffer>>>, random: () => number) {
  const faults = { late: 0, gone: 0, refused: 0, torn: 0 };
  const server = {
    faults,
    isSteady: false,
    isDown: false,
    fetch: async (url: string, { headers, signal }: RequestInit) => {
      const fault = server.isSteady
        ? undefined
        : (['late', 'gone', 'refused', 'torn'] as const)[Math.floor(20 * random())];
      if (fault) faults[fault]++;
      for (let task = 0; fault === 'late' && task < 40; task++) await nextTask();
      signal?.throwIfAborted();
      if (server.isDown || fault === 'gone') throw new TypeError('fetch failed');
      if (fault === 'refused') return new Response(null, { status: 503 });
      const bytes = files[new URL(url).pathname.slice(1)];
      const from = Number(/^bytes=(\d+)-/.exec(new Headers(headers).get('range') ?? '')?.[1] ?? 0);
      const part = bytes.subarray(from);
      const body = new ReadableStream({
        start(controller) {
          controller.enqueue(fault === 'torn' ? part.slice(0, part.length / 2) : part.slice());
          if (fault === 'torn') controller.error(new TypeError('terminated'));
          else controller.close();
        },
      });
      const about = { etag: '"1"', 'accept-ranges': 'bytes', 'content-length': String(part.length) };
      const range = { 'content-range': `bytes ${from}-${bytes.length - 1}/${bytes.length}` };
      return from > 0
        ? new Response(body, { status: 206, headers: { ...about, ...range } })
        : new Response(body, { headers: about });
    },
  };
  return server;
}

function countObjects(): number[] {
  return COUNTED.map((made) => queryObjects(made, { format: 'count' }) as unknown as number);
}

/**
 * @fault Devices and engines: 2,500 frames of a stream that is larger than its budget, from a server that
 *   is late, gone, busy or torn, with a new cloud at every 25th frame
 * @consequence the budget holds; every image shows each leaf at one level; no memory, promise, signal or
 *   listener is left; the image equals a fresh cloud, bit for bit
 */
gpuTest(
  `streams through ${FRAMES} frames, a server's failures and ends of clouds, and leaves nothing`,
  async () => {
    const random = seededRandom(7);
    const page = new EventTarget();
    vi.stubGlobal('addEventListener', page.addEventListener.bind(page));
    vi.stubGlobal('removeEventListener', page.removeEventListener.bind(page));
    const set = randomSplats({ count: 60 * LEAVES, seed: 2, shDegree: 0, logScales: [-4, -2] });
    const sog = await streamedSog({ set, filesOfLevel: [LEAVES, 3, 1], leafCount: LEAVES });
    const server = unsteadyServer(streamedSogFiles(sog), random);
    vi.stubGlobal('fetch', server.fetch);

    const device = await shareTestDevice();
    const engine = await SplatEngine.create({
      device,
      accuracy: { rasterizer: 'quads', sortKeyBits: 16 },
      // Divided frames would leave out those that are asked for meanwhile.
      submissionBudgetMs: Number.POSITIVE_INFINITY,
    });
    const context = streamContext(device);
    const view = engine.createView();
    let failedLoads = 0;
    const load = async (): Promise<Shown> => {
      for (;;)
        try {
          const opened = await openLeaves(knownSource('https://a.example/lod-meta.json'), {
            request: { maxRetries: 2 },
          });
          const scene = byLevel(opened!);
          return { scene, cloud: await streamLeaves(context, scene, { budgetBytes: BUDGET_BYTES }, {}) };
        } catch (error) {
          expect(error).toBeInstanceOf(SplatSourceError);
          failedLoads++;
          server.isDown = false;
        }
    };
    const cameraAt = (angle: number, height: number) =>
      perspectiveCamera({
        position: [1.6 * Math.sin(angle), height, 1.6 * Math.cos(angle)],
        target: [0, 0, 0],
        up: [0, 1, 0],
        fovYDegrees: 60,
        aspect: SIZE.widthPx / SIZE.heightPx,
      });
    /** The picture from one place once all is there that the budget holds. */
    const restOf = async ({ cloud }: Shown) => {
      server.isSteady = true;
      await view.whenDrawn();
      view.render({ camera: cameraAt(1, 0.3), clouds: [{ cloud }], ...SIZE, detail: DETAILS[0] });
      do {
        cloud.stream!.retry();
        await view.whenComplete();
        // Parts that were on their way may have failed yet.
      } while (cloud.stream!.report().error);
      server.isSteady = false;
      expect(cloud.stream!.report()).toMatchObject({ isComplete: true });
      return (await view.readPixels()).data;
    };
    const left = () => ({
      pool: context.memory.report().resources,
      frameBytes: engine.memory().totalBytes,
      objects: countObjects(),
    });

    let shown = await load();
    let moments = watchCuts(shown.cloud, (...cut) => expectOneLevel(shown.scene, ...cut));
    let [changes, retries, angle] = [0, 0, 0];
    let early: ReturnType<typeof left> | undefined;
    for (let frame = 1; frame <= FRAMES; frame++) {
      if (frame % CLOUD_FRAMES === 0) {
        changes += moments();
        shown.cloud.destroy();
        server.isDown = frame % DOWN_FRAMES === 0;
        shown = await load();
        const { scene } = shown;
        moments = watchCuts(shown.cloud, (...cut) => expectOneLevel(scene, ...cut));
      }
      const { cloud, scene } = shown;
      angle += random() < 0.1 ? 2 * Math.PI * random() : 0.3 * random();
      const detail = DETAILS[Math.floor(DETAILS.length * random())];
      view.render({ camera: cameraAt(angle, 2 * random() - 1), clouds: [{ cloud }], ...SIZE, detail });
      expect(cloud.bytes).toBeLessThanOrEqual(BUDGET_BYTES);
      if (frame % AT_ONCE === 0) await device.queue.onSubmittedWorkDone();
      if (frame % LOOK_FRAMES === 0)
        expectOneLevel(scene, await expectShown(device, cloud), `frame ${frame}`);
      if (cloud.stream!.report().error) {
        retries++;
        page.dispatchEvent(new Event('online'));
      }
      if (frame === FRAMES / 10) {
        await restOf(shown);
        early = left();
      }
    }
    const last = await restOf(shown);
    const end = left();
    for (const [i, count] of end.objects.entries())
      expect(count, COUNTED[i].name).toBeLessThan(early!.objects[i] + LEFT_OBJECTS);
    expect(getEventListeners(page, 'online')).toHaveLength(1);
    expect(changes).toBeGreaterThan(FRAMES / 10);
    expect(failedLoads).toBeGreaterThanOrEqual(FRAMES / DOWN_FRAMES);
    expect(Math.min(retries, ...Object.values(server.faults))).toBeGreaterThan(0);
    expect(end.pool).toEqual(early!.pool);
    expect(end.frameBytes).toBeLessThanOrEqual(early!.frameBytes);
    expect(await restOf(await load())).toEqual(last);
    expect(last.some((value) => value > 0.1)).toBe(true);
    engine.destroy();
  },
  TIME_LIMIT_MS,
);
