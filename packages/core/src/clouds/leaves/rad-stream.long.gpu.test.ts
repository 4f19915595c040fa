import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import type { LeafLevel, LeafScene, SceneLeaf } from '../../data/bricks/leaf-scene.ts';
import { SplatFileError, SplatSourceError } from '../../data/errors.ts';
import { nextTask } from '../../data/turns.ts';
import { frameScene } from '../../framing/frame-scene.ts';
import { openRad } from '../../io/formats/rad/open-rad.ts';
import { readSplats } from '../../io/loading/read-splats.ts';
import { knownSource } from '../../io/sources/known-source.ts';
import { compareImages } from '../../stages/measure/measure.reference.ts';
import { FIXED_RASTERIZER } from '../../testing/fixed-rasterizer.ts';
import {
  drawComplete,
  expectCuts,
  lookFrom,
  numbered,
  SIZE,
  streamContext,
} from '../../testing/look-at-streams.ts';
import { nestedNodes, type RadLayout, radBytes, radFiles } from '../../testing/rad-fixture.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { signalOf } from '../../testing/signal.ts';
import { droppedFiles } from '../../testing/sog-fixture.ts';
import { chunkBytes } from '../stream/chunk-pages.ts';
import { streamLeaves } from './stream-leaves.ts';

describe('a .rad', () => {
  const nodes = nestedNodes(16_000, 1000);
  const layout: RadLayout = { degree: 1, chunkSize: 1000, encodings: { alpha: 'f32' } };
  const bytes = radBytes(nodes, layout);
  let engine: SplatEngine;
  beforeAll(async () => {
    engine = await SplatEngine.create({ device: await shareTestDevice(), accuracy: FIXED_RASTERIZER });
  });

  const file = () => new File([bytes], 'scene.rad');
  const opened = async () => (await openRad(knownSource(file())))!;
  const stream = (from: LeafScene, budgetBytes?: number) =>
    streamLeaves(streamContext(engine.device), from, { budgetBytes }, {});

  gpuTest('shows its first chunk at once, and in the end its finest level', async () => {
    const whole = engine.add(await readSplats(file()));
    const { data: full } = await drawComplete(engine, whole);
    const { when, give } = signalOf();
    const own = await opened();
    const first = own.fetchedBytes;
    expect(first).toBeLessThan(bytes.length / 10);
    const cloud = await stream({
      ...own,
      read: async (number, signal) => {
        if (number > 0) await when;
        return own.read(number, signal);
      },
    });
    const view = engine.createView();
    view.render({ camera: lookFrom([0, 0, 4]), clouds: [{ cloud }], ...SIZE });
    const coarse = (await view.readPixels()).data;
    expect(view.detail).toMatchObject({ isComplete: false });
    give();
    await view.whenComplete();
    expect(view.detail).toMatchObject({ isComplete: true, missing: 0 });
    const { data } = await view.readPixels();
    const [before, after] = [coarse, data].map((each) => compareImages(each, full, SIZE).psnrDb);
    expect(before).toBeGreaterThan(15);
    expect(before).toBeLessThan(40);
    expect(after).toBeGreaterThan(60);
    view.destroy();
    whole.destroy();
    cloud.destroy();
  });

  gpuTest('is framed by its first chunk, whatever is there', async () => {
    const cloud = await stream(await opened());
    const first = await frameScene([{ cloud }]);
    expect(first!.radius).toBeGreaterThan(0);
    await drawComplete(engine, cloud);
    expect(await frameScene([{ cloud }])).toEqual(first);
    cloud.destroy();
  });

  gpuTest('is loaded from a file, and from several', async () => {
    const found = [];
    for (const source of [file(), bytes, droppedFiles(radFiles(nodes, layout, 'scene/'))]) {
      const cloud = await engine.load(source, { name: 'scene.rad' });
      expect(cloud.stream).not.toBeNull();
      const { data, report } = await drawComplete(engine, cloud);
      expect(report).toMatchObject({ missing: 0, isComplete: true });
      found.push(data);
      cloud.destroy();
    }
    expect(found[1]).toEqual(found[0]);
    expect(found[2]).toEqual(found[0]);
    const single = await engine.load(new File([radBytes(nodes, { degree: 1 })], 'one.rad'));
    expect(single.stream).toBeNull();
    single.destroy();
  });

  gpuTest('draws each part once at each moment, while parts come and go in any order', async () => {
    const own = await opened();
    /** Twice the number of a leaf, and 1 more on its coarsest level. */
    const numberOf = (leaf: SceneLeaf, level: LeafLevel) =>
      2 * own.leaves.indexOf(leaf) + Number(leaf.levels.length > 1 && level === leaf.levels[1]);
    const cloud = await stream(numbered(own, numberOf), 60 * chunkBytes(own.shDegree));
    /** Of leaves whose finest level is shown, these that are a part of it are shown, and no others. */
    const expectCut = (numbers: readonly number[], when: string) => {
      const shown = new Set(numbers);
      const isFinest = (i: number) => shown.has(2 * i);
      const isCoarsest = (i: number) => shown.has(2 * i + 1);
      for (const [i, { above, levels }] of own.leaves.entries()) {
        if (levels.length === 1) continue;
        // Some have nothing but parts.
        const isThere = isFinest(i) || own.leaves.some((part, k) => part.above === i && isThereIn(k));
        expect(isThere && isCoarsest(i), `${when}: both levels of ${i}`).toBe(false);
        const isDue = above === undefined || isOpen(above);
        expect(isThere || isCoarsest(i), `${when}: ${i}`).toBe(isDue);
      }
      function isThereIn(i: number): boolean {
        return isFinest(i) || isCoarsest(i) || isOpen(i);
      }
      function isOpen(i: number): boolean {
        return isFinest(i) || own.leaves.some((part, k) => part.above === i && isThereIn(k));
      }
      return [...shown].sort((a, b) => a - b).join();
    };
    await expectCuts(engine, cloud, { steps: 30, reach: 1.5 }, expectCut);
  });

  gpuTest('shows the same bit for bit, in whatever order parts came, within its budget', async () => {
    const budgetBytes = 48 * chunkBytes(1);
    const views = [
      { camera: lookFrom([0.1, 0.3, 1.2]), detail: { maxErrorPx: 2 } },
      { camera: lookFrom([1.2, 0.4, 0.2]), detail: 'full' },
      { camera: lookFrom([9, 14, 21]), detail: { maxErrorPx: 1 } },
      { camera: lookFrom([0.3, -2, 2]), detail: { maxSplats: 3000 } },
    ] as const;
    const found = [];
    for (const { camera, detail } of views) {
      const fresh = await stream(await opened(), budgetBytes);
      expect(fresh.bytes).toBeLessThanOrEqual(budgetBytes);
      found.push(await drawComplete(engine, fresh, { detail }, camera));
      expect(found.at(-1)!.report).toMatchObject({ isComplete: true });
      fresh.destroy();
    }
    expect(found[1].report.missing).toBeGreaterThan(0);
    const random = seededRandom(7);
    const own = await opened();
    const cloud = await stream(
      {
        ...own,
        get leaves() {
          return own.leaves;
        },
        read: async (number, signal) => {
          for (let turn = 0; turn < 30 * random(); turn++) await nextTask();
          return own.read(number, signal);
        },
      },
      budgetBytes,
    );
    for (const i of [2, 0, 3, 1, 0, 2, 1, 3]) {
      const { camera, detail } = views[i];
      expect((await drawComplete(engine, cloud, { detail }, camera)).data, `view ${i}`).toEqual(
        found[i].data,
      );
      const { residentBricks, mostBricks } = cloud.stream!.report();
      expect(residentBricks).toBeLessThanOrEqual(mostBricks);
      expect(cloud.bytes).toBeLessThanOrEqual(budgetBytes);
    }
    cloud.destroy();
  });

  gpuTest('fetches only what a view needs, and within a budget of splats less', async () => {
    const fetchedAfter = async (detail: object, camera = lookFrom([0, 0, 4])) => {
      const cloud = await stream(await opened());
      await drawComplete(engine, cloud, detail, camera);
      const { residentBricks } = cloud.stream!.report();
      cloud.destroy();
      return residentBricks;
    };
    const full = await fetchedAfter({});
    expect(await fetchedAfter({ detail: { maxErrorPx: 1 } }, lookFrom([0, 0, 60]))).toBeLessThan(0.5 * full);
    expect(await fetchedAfter({ detail: { maxSplats: 3000 } })).toBeLessThan(0.7 * full);
  });

  /**
   * @fault Files: a chunk of a .rad is missing, damaged, or has children out of place or with several
   *   parents
   */
  gpuTest('tells what is wrong, draws what is there, and goes on, or ends', async () => {
    for (const [error, from] of [
      [new SplatSourceError('scene.rad', 'it is gone.'), SplatSourceError],
      [new SplatFileError('damaged', 'scene.rad', 'it is damaged.'), SplatFileError],
    ] as const) {
      const own = await opened();
      let isBroken = true;
      const cloud = await stream({
        ...own,
        read: async (number, signal) => {
          if (isBroken && number > 3) throw error;
          return own.read(number, signal);
        },
      });
      const { data, report } = await drawComplete(engine, cloud);
      expect(data.some((value) => value > 0.1)).toBe(true);
      expect(report.missing).toBeGreaterThan(0);
      expect(cloud.stream!.report()).toMatchObject({ error: expect.any(from), isComplete: false });
      isBroken = false;
      cloud.stream!.retry();
      expect((await drawComplete(engine, cloud)).report).toMatchObject({ isComplete: true, missing: 0 });
      cloud.destroy();
    }
    const { totalBytes } = engine.memory();
    await expect(engine.load(file(), { budgetBytes: 1000 })).rejects.toThrow(/budgetBytes is 1000; .* needs/);
    const aborted = { signal: AbortSignal.abort(new Error('enough')) };
    await expect(engine.load(file(), aborted)).rejects.toThrow('enough');
    expect(engine.memory().totalBytes).toBe(totalBytes);
    const own = await opened();
    const signals: AbortSignal[] = [];
    const { when, give } = signalOf();
    const cloud = await stream({
      ...own,
      read: async (number, signal) => {
        if (number > 0) {
          signals.push(signal!);
          await when;
        }
        return own.read(number, signal);
      },
    });
    const view = engine.createView();
    view.render({ camera: lookFrom([0, 0, 4]), clouds: [{ cloud }], ...SIZE });
    await null;
    expect(signals.length).toBeGreaterThan(0);
    cloud.destroy();
    expect(signals.every(({ aborted: isAborted }) => isAborted)).toBe(true);
    give();
    view.destroy();
  });
});
