import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import type { BrickScene } from '../../data/bricks/brick.ts';
import { brickSceneOf } from '../../data/bricks/make-bricks.ts';
import { perspectiveCamera } from '../../data/camera/camera.ts';
import { SplatFileError } from '../../data/errors.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { ChunkLinks, LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import type { Detail } from '../../frame/plan/detail.ts';
import { GpuMemory } from '../../gpu/gpu-memory.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { readWords } from '../../gpu/read-buffer.ts';
import { drawMeasured } from '../../measure/measured-frames.ts';
import { isDrawnAt, linkParts } from '../../reference/level-link.ts';
import { type CutValues, cellThreshold } from '../../stages/cut/cut.reference.ts';
import { compareImages } from '../../stages/measure/measure.reference.ts';
import { FIXED_RASTERIZER } from '../../testing/fixed-rasterizer.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import type { SplatCloud } from '../splat-cloud.ts';
import { BrickPool, type PlacedBrick, type PlacedCell, slotBytes } from './brick-pool.ts';

const SIZE = { widthPx: 96, heightPx: 64 };
const isFull = process.env.WEBSPLATTER_FULL === '1';
/** Bricks that come or go. */
const STEPS = isFull ? 10 : 4;
const camera = perspectiveCamera({
  position: [0, 0, 4],
  target: [0, 0, 0],
  up: [0, 1, 0],
  fovYDegrees: 40,
  aspect: 1.5,
});

describe('a pool of bricks', () => {
  const set = randomSplats({ count: 9000, seed: 2, shDegree: 1, logScales: [-6, -3] });
  let engine: SplatEngine;
  let scene: BrickScene;
  let whole: SplatCloud;
  beforeAll(async () => {
    const device = await shareTestDevice();
    engine = await SplatEngine.create({ device, accuracy: FIXED_RASTERIZER });
    scene = brickSceneOf(set);
    whole = engine.add(set);
    await whole.makeLevels();
  });

  async function poolOf(shown = scene, slots = { lowest: 3, upper: 4 }) {
    const { device } = engine;
    const memory = new GpuMemory(device);
    const context = { device, memory, pipelines: new Pipelines(device), dispatchRow: 7 };
    const pool = await BrickPool.make(context, shown, slots);
    await pool.ready(0);
    const cloud = pool.cloud();
    const root = pool.place(await shown.read(shown.root), shown.root, null);
    pool.merge();
    return { pool, cloud, root, memory };
  }

  async function draw(cloud: SplatCloud, detail: Detail = 'full') {
    const view = engine.createView();
    view.render({ camera, clouds: [{ cloud }], ...SIZE, detail });
    const { data } = await view.readPixels();
    view.destroy();
    return data;
  }

  async function placeBelow(pool: BrickPool, cell: PlacedCell, shown = scene): Promise<PlacedBrick> {
    return pool.place(await shown.read(cell.child!), cell.child!, cell);
  }

  /** Places all bricks, in an order that `random` chooses, and merges a few at a time. */
  async function placeAll(
    pool: BrickPool,
    root: PlacedBrick,
    random = seededRandom(1),
  ): Promise<PlacedBrick[]> {
    const placed: PlacedBrick[] = [];
    const open = [...root.cells];
    while (open.length > 0) {
      const [cell] = open.splice(Math.floor(random() * open.length), 1);
      if (!cell.child) continue;
      placed.push(await placeBelow(pool, cell));
      open.push(...placed.at(-1)!.cells);
      if (random() < 0.3) pool.merge();
    }
    pool.merge();
    return placed;
  }

  gpuTest('with all bricks there, in any order, is the scene as if it had been loaded', async () => {
    const { pool, cloud, root } = await poolOf();
    expect(scene.brickCount).toBeGreaterThan(3);
    await placeAll(pool, root);
    expect(pool.bricks).toHaveLength(scene.brickCount);
    const full = await draw(whole);
    expect(compareImages(await draw(cloud), full, SIZE).psnrDb).toBeGreaterThan(80);
    for (const detail of [{ maxErrorPx: 1 }, { maxSplats: 1500 }]) {
      const cut = compareImages(await draw(whole, detail), full, SIZE).psnrDb;
      expect(compareImages(await draw(cloud, detail), full, SIZE).psnrDb).toBeCloseTo(cut, 0);
    }
    cloud.destroy();
  });

  gpuTest(
    'draws each splat once, whatever is there and at any error: itself, or one that stands for it',
    { tags: 'deeper' },
    async () => {
      const random = seededRandom(4);
      // Errors that the GPU would not find: those of the file count.
      const raised: BrickScene = {
        ...scene,
        read: async (address) => {
          const brick = await scene.read(address);
          const cells = brick.cells.map((cell) => ({
            ...cell,
            childErrors: cell.childErrors.map((e) => e + 9),
          }));
          return { ...brick, cells };
        },
      };
      const { pool, cloud, root } = await poolOf(raised);
      const resident = [root];
      const change = async () => {
        const open = resident.flatMap(({ cells }) => cells.filter(({ child, below }) => child && !below));
        const childless = resident.filter(({ above, cells }) => above && !cells.some(({ below }) => below));
        if (open.length > 0 && (childless.length === 0 || random() < 0.7)) {
          resident.push(await placeBelow(pool, open[Math.floor(random() * open.length)], raised));
        } else {
          const [gone] = childless.splice(Math.floor(random() * childless.length), 1);
          pool.remove(gone);
          resident.splice(resident.indexOf(gone), 1);
        }
      };
      for (let run = 0; run < STEPS; run++) {
        for (let changes = Math.ceil(3 * random()); changes > 0; changes--) await change();
        pool.merge();
        const links = await linksOf(pool);
        for (let each = 0; each < 4; each++) {
          const cut = {
            camera: [0, 1, 2].map(() => 4 * random() - 2) as [number, number, number],
            squaredPerDistance: each === 0 ? 0 : 10 ** (-8 * random()),
            leastSquared: each === 1 ? 10 ** (-6 * random()) : 0,
            margin: 0,
          };
          const wrong = resident.flatMap((brick) =>
            brick.cells.filter((cell) => timesDrawn(links, cell, cut).some((times) => times !== 1)),
          );
          expect(wrong.length, `run ${run}, cut ${each}`).toBe(0);
        }
      }
      cloud.destroy();
    },
  );

  gpuTest('is the same picture in any order of arrival, bit for bit, and after what has gone', async () => {
    const { pool, cloud, root } = await poolOf();
    const coarse = await draw(cloud);
    const placed = await placeAll(pool, root);
    const full = await draw(cloud);
    expect(full).not.toEqual(coarse);
    for (const brick of placed.toReversed()) pool.remove(brick);
    pool.merge();
    expect(await draw(cloud)).toEqual(coarse);
    await placeAll(pool, root, seededRandom(9));
    expect(await draw(cloud)).toEqual(full);
    cloud.destroy();
  });

  gpuTest('keeps a budget, whatever is there, and comes near to it', { tags: 'deeper' }, async () => {
    const { pool, cloud, root } = await poolOf();
    const view = engine.createView();
    const drawn = async (maxSplats: number, shown = cloud) => {
      const request = { camera, clouds: [{ cloud: shown }], ...SIZE, detail: { maxSplats }, force: true };
      return (await drawMeasured(engine, view, request)).visibleSplats;
    };
    const coarsest = await drawn(8000);
    expect(coarsest).toBeGreaterThan(0);
    const open = [...root.cells];
    let placed = 0;
    for (let cell = open.pop(); cell; cell = open.pop()) {
      if (!cell.child) continue;
      open.push(...(await placeBelow(pool, cell)).cells);
      pool.merge();
      placed++;
      if (!isFull && placed % 3 !== 0) continue;
      for (const budget of [400, 2000]) expect(await drawn(budget)).toBeLessThanOrEqual(budget);
    }
    expect((await drawn(2000)) / (await drawn(2000, whole))).toBeCloseTo(1, 1);
    view.destroy();
    cloud.destroy();
  });

  gpuTest('takes no memory once it is made, and frees it with its cloud', async () => {
    const { pool, cloud, root, memory } = await poolOf();
    const { totalBytes } = memory.report();
    const { lowest, upper } = slotBytes(scene.shDegree);
    const slots = lowest * pool.slots.lowest + upper * pool.slots.upper;
    expect(totalBytes).toBeGreaterThanOrEqual(slots);
    expect(totalBytes).toBeLessThan(slots + 1000);
    await placeAll(pool, root);
    expect(memory.report().totalBytes).toBe(totalBytes);
    expect(cloud.bytes).toBe(totalBytes);
    cloud.destroy();
    expect(memory.report().totalBytes).toBe(0);
  });

  gpuTest('refuses bricks that do not fit their place, and stays as it is', async () => {
    const { pool, cloud, root } = await poolOf();
    const before = await draw(cloud);
    const [cell] = root.cells;
    const brick = await scene.read(cell.child!);
    const cells = brick.cells.slice(1);
    expect(() => pool.place({ ...brick, cells }, cell.child!, cell)).toThrow(
      /Brick 1 has \d+ cells, and \d+ are to be there\. Convert the scene again\./,
    );
    expect(() => pool.place({ ...brick, level: 2 }, cell.child!, cell)).toThrow(SplatFileError);
    expect(pool.bricks).toHaveLength(1);
    expect(await draw(cloud)).toEqual(before);
    cloud.destroy();
  });

  /** Links of all chunks, with their heads. */
  async function linksOf(pool: BrickPool) {
    const read = (buffer: GPUBuffer) => readWords(engine.device, buffer);
    const splats = await Promise.all(pool.splatLinks.map(read));
    const blobs = await Promise.all(pool.blobPages.map(({ links }) => read(links)));
    return {
      splats: splats.flatMap((words) => [...words]),
      blobs: blobs.slice(0, -1).flatMap((words) => [...words]),
      upper: [...blobs.at(-1)!],
      chunkCells: pool.chunkCells,
    };
  }
});

type PoolLinks = { splats: number[]; blobs: number[]; upper: number[]; chunkCells: number };

/** The words of the chunks of a cell: of its leaves, and of its blobs. */
function chunksOf({ splats, blobs, upper, chunkCells }: PoolLinks, { cell }: PlacedCell) {
  const part = (words: number[], chunk: number) =>
    words.slice(ChunkLinks.words * chunk, ChunkLinks.words * (chunk + 1));
  if (cell < chunkCells) return { leaves: part(splats, cell), blobs: part(blobs, cell) };
  const chunk = 2 * (cell - chunkCells);
  return { leaves: part(upper, chunk), blobs: part(upper, chunk + 1) };
}

/** How often each leaf of a cell is drawn that nothing below stands in for: itself, or what stands for it. */
function timesDrawn(links: PoolLinks, cell: PlacedCell, cut: CutValues): number[] {
  if (cell.below) return [];
  const head = ChunkLinks.words - CHUNK_SPLATS;
  const thresholdOf = ({ bounds }: PlacedCell) => cellThreshold(bounds, cut);
  const drawnAbove = (at: PlacedCell, place: number): number => {
    const { leaves, blobs } = chunksOf(links, at);
    const { above } = at.brick;
    const isOpen = (words: number[]) => !above || thresholdOf(above) < words[1];
    const limit = thresholdOf(at);
    const isDrawn = (words: number[], link: number) =>
      Number(isOpen(words) && words[2] <= limit && limit < words[3] && isDrawnAt(link, limit));
    let link = leaves[head + place];
    let times = isDrawn(leaves, link);
    let { parentSlot, parentError } = linkParts(link);
    while (parentError !== LEVEL_CONSTANTS.ERROR_BOUNDLESS) {
      const slot = parentSlot;
      link = blobs[head + slot];
      times += isDrawn(blobs, link);
      ({ parentSlot, parentError } = linkParts(link));
      if (parentError !== LEVEL_CONSTANTS.ERROR_BOUNDLESS) continue;
      if (!above) break;
      const isRoot = (other: number) =>
        other !== 0 && linkParts(other).parentError === LEVEL_CONSTANTS.ERROR_BOUNDLESS;
      const rank = blobs.slice(head, head + slot).filter(isRoot).length;
      times += drawnAbove(above, 16 * at.brick.cells.indexOf(at) + rank);
    }
    return times;
  };
  const { leaves } = chunksOf(links, cell);
  return leaves.slice(head).flatMap((link, place) => (link === 0 ? [] : [drawnAbove(cell, place)]));
}
