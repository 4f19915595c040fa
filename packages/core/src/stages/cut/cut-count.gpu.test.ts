import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { ChunkLinks, CutPlan, LEVEL_CONSTANTS, LevelCell } from '../../data/layout/level-structs.ts';
import { Chunk, Page } from '../../data/layout/structs.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { joined, packFlatPage, packFlatView } from '../../testing/flat-view.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { type CountedChunk, cutCount as reference, touchCell } from './cut.reference.ts';
import { countWorkgroups, cutCount } from './cut.ts';

const { CELL_ROOTS, COUNT_ANEW, COUNT_NOTHING, CUT_BINS, CUT_COPIES, ERROR_BOUNDLESS, NO_CELL, SHIFT_NONE } =
  LEVEL_CONSTANTS;
const isFull = process.env.WEBSPLATTER_FULL === '1';
const DISPATCH_ROW = 4;
const CELLS = 19;
const CHUNKS = 2 * CELLS;
/** Splats of the last chunk. */
const LAST_COUNT = 100;
const gpu = testGpu();

/** A half-space: what is above y = -10. */
const ABOVE = [0, 1, 0, 10];
const EVERYWHERE = [0, 0, 0, 1];

interface RandomChunk {
  readonly links: readonly number[];
  readonly blobCount: number;
  readonly pairs: number;
  readonly uncounted: number;
}

/**
 * Cells, each below the one before it, at x = cell; of every three one is out of sight, and of one
 * every second node. Of every four one has leaves of a level above. Of some, splats are touched and
 * some of these hidden. Chunk 2i are the blobs of cell i, chunk 2i + 1 its leaves.
 */
function randomCells() {
  const random = seededRandom(9);
  const below = (end: number) => Math.floor(random() * end);
  let limit = 0;
  return Array.from({ length: CELLS }, (_, cell) => {
    limit += below(150);
    const isUpper = cell % 4 === 3;
    const count = cell === CELLS - 1 ? LAST_COUNT : isUpper ? 10 + below(240) : CHUNK_SPLATS;
    const errors = Array.from({ length: count }, () => (isUpper ? 1 + below(1000) : 0));
    const [blobs, leaves] = randomTree(errors, below);
    const chunks = cell % 4 === 0 || cell === 3 ? touched([blobs, leaves], isUpper, below) : [blobs, leaves];
    const cellError = Math.max(...chunks[0].links.map((link) => (link >>> 12 === 0xfff ? link & 0xfff : 0)));
    const isInSight = (slot: number) => cell % 3 === 0 || (cell % 3 === 1 && slot % 2 === 1);
    return { limit, parent: cell === 0 ? NO_CELL : cell - 1, cellError, chunks, isInSight };
  });
}

/** Blobs, two nodes each until sixteen are left, and the leaves with these errors. */
function randomTree(leaves: readonly number[], below: (end: number) => number): [RandomChunk, RandomChunk] {
  const leafLinks = [...leaves];
  const blobLinks: number[] = [];
  const roots = leaves.map((error, slot) => ({ error, slot, links: leafLinks }));
  const put = (error: number, nodes: typeof roots) => {
    const parent = { error: Math.max(1, error), slot: blobLinks.length, links: blobLinks };
    for (const { links, slot } of nodes) links[slot] += parent.error * 2 ** 12 + parent.slot * 2 ** 24;
    blobLinks.push(parent.error);
    return parent;
  };
  const take = () => roots.splice(below(roots.length), 1)[0];
  while (roots.length > CELL_ROOTS) {
    const pair = [take(), take()];
    roots.push(put(Math.max(...pair.map(({ error }) => error)) + below(300), pair));
  }
  const pairs = blobLinks.length;
  const tops = roots.map((root) => (root.links === leafLinks ? put(root.error, [root]) : root));
  for (const { slot } of tops) blobLinks[slot] += ERROR_BOUNDLESS * 2 ** 12;
  const chunk = (links: readonly number[], blobCount: number): RandomChunk => ({
    links: Array.from({ length: CHUNK_SPLATS }, (_, slot) => links[slot] ?? 0),
    blobCount,
    pairs: blobCount && pairs,
    uncounted: 0,
  });
  return [chunk(blobLinks, blobLinks.length), chunk(leafLinks, 0)];
}

/** The same, around a few of the leaves. */
function touched(
  [blobs, { links, ...leaves }]: [RandomChunk, RandomChunk],
  isUpper: boolean,
  below: (end: number) => number,
): [RandomChunk, RandomChunk] {
  const states = links.map(() => below(20));
  const isTouched = (slot: number) => states[slot] < 2;
  const told = links.map((link, slot) =>
    isUpper && link && isTouched(slot) ? link | ERROR_BOUNDLESS : link,
  );
  const isHidden = (slot: number) => !isUpper && states[slot] === 0;
  const refined = touchCell({ leaves: told, blobs: blobs.links }, isTouched, isHidden);
  return [
    { ...blobs, links: refined.blobs },
    { ...leaves, links: refined.leaves, uncounted: refined.uncounted },
  ];
}

async function countsOf(
  cells: ReturnType<typeof randomCells>,
  base: number,
  variant: Parameters<typeof cutCount>[0],
  pipelines?: Pipelines,
  instances = [{ side: ABOVE, limits: 0 }],
  next: number = COUNT_ANEW,
) {
  const contents = new ArrayBuffer(CELLS * LevelCell.bytes);
  const words = GEOMETRY_WORDS[variant.geometryPrecision];
  const geometry = new Float32Array(CHUNKS * CHUNK_SPLATS * words);
  for (const [cell, { parent, isInSight }] of cells.entries()) {
    const y = Array.from({ length: CHUNK_SPLATS }, (_, slot) => (isInSight(slot) ? 0 : -100));
    const minPosition = [cell, Math.min(...y), 0];
    const maxPosition = [cell + 1, Math.max(...y), 1];
    LevelCell.write(contents, { minPosition, maxPosition, parent }, cell * LevelCell.bytes);
    for (const chunk of [2 * cell, 2 * cell + 1])
      for (const [slot, at] of y.entries())
        geometry.set([cell, at, 0], (chunk * CHUNK_SPLATS + slot) * words);
  }
  const linkWords = cells.flatMap(({ cellError, chunks }, cell) =>
    chunks.flatMap(({ links, blobCount, pairs, uncounted }) => {
      const used = links.filter((link) => link !== 0);
      const leastError = Math.min(...used.map((link) => link & 0xfff));
      const largestParentError = Math.max(...used.map((link) => (link >>> 12) & 0xfff));
      return [cell, cellError, leastError, largestParentError, 0, blobCount, pairs, uncounted, ...links];
    }),
  );
  expect(linkWords.length).toBe(CHUNKS * ChunkLinks.words);
  const splatCount = (CHUNKS - 1) * CHUNK_SPLATS + LAST_COUNT;
  const pages = instances.map(({ side }, i) => packFlatPage(CHUNKS * i, CHUNKS, side, splatCount, CELLS * i));
  const behind = [new ArrayBuffer(Page.bytes * ((variant.batchInstances ?? 1) - pages.length))];
  const cutCounts = gpu.storage([], 4 * CUT_BINS * CUT_COPIES);
  const bindings = {
    view: gpu.uniform(
      packFlatView({ size: { widthPx: 1, heightPx: 1 }, alphaCutoff: 0, dispatchRow: DISPATCH_ROW }),
    ),
    [variant.batchInstances ? 'pages' : 'page']: gpu.uniform(joined([...pages, ...behind])),
    links: gpu.storage(linkWords),
    cells: gpu.storage(new Uint32Array(contents)),
    thresholds: gpu.storage(instances.flatMap(({ limits }) => cells.map(({ limit }) => limit + limits))),
    cutPlan: gpu.storage(
      new Uint32Array(CutPlan.pack({ leastShift: base - 100, base, next, shift: 0, budget: 0 })),
    ),
    cutCounts,
    geometry: gpu.storage(new Uint32Array(geometry.buffer)),
    chunks: gpu.storage([], Chunk.bytes * CHUNKS),
  };
  await gpu.run(
    cutCount(variant),
    bindings,
    dispatchSize(countWorkgroups(CHUNKS * instances.length, variant.sortDevice) + 1, DISPATCH_ROW),
    pipelines,
  );
  const changes = await gpu.read(cutCounts);
  let sum = 0;
  return Array.from({ length: CUT_BINS }, (_, bin) => {
    for (let copy = 0; copy < CUT_COPIES; copy++) sum = (sum + changes[copy * CUT_BINS + bin]) >>> 0;
    return sum;
  });
}

describe('cut-count', () => {
  const cells = randomCells();
  const countedIf = (isCounted: (cell: number, slot: number) => boolean) =>
    cells.flatMap(({ limit, parent, cellError, chunks }, cell) =>
      chunks.map(
        ({ links }): CountedChunk => ({
          limit,
          parentLimit: parent === NO_CELL ? null : cells[parent].limit,
          cellError,
          links: links.filter((_, slot) => isCounted(cell, slot)),
        }),
      ),
    );
  const known = new Map<readonly CountedChunk[], Map<number, readonly number[]>>();
  /** What the reference counts at each shift from `base` on: computed once for all tests. */
  const expectedAt = (counted: readonly CountedChunk[], base: number): readonly number[] => {
    const byBase = known.get(counted) ?? new Map<number, readonly number[]>();
    known.set(counted, byBase);
    const expected =
      byBase.get(base) ?? Array.from({ length: CUT_BINS }, (_, i) => reference(counted, base + i));
    byBase.set(base, expected);
    return expected;
  };
  const inSight = countedIf((cell, slot) => cells[cell].isInSight(slot));
  const ofChunks = countedIf((cell) => cell % 3 !== 2);
  for (const base of [SHIFT_NONE - 1000, SHIFT_NONE, SHIFT_NONE + 700]) {
    for (const [geometryPrecision, culling, isNarrow, counted] of [
      ['f32', 'bounding-box', false, inSight],
      ['packed', 'bounding-box', true, inSight],
      ['packed', 'frustum', false, ofChunks],
      ['packed', 'frustum', true, ofChunks],
    ] as const) {
      gpuTest(
        `${geometryPrecision}, ${culling}${isNarrow ? ', on a CPU' : ''}: what is drawn at shifts from ${base} on`,
        async () => {
          const expected = expectedAt(counted, base);
          const variant = { geometryPrecision, culling, sortDevice: { isNarrow } };
          expect(await countsOf(cells, base, variant)).toEqual(expected);
          expect(new Set(expected).size).toBeGreaterThan(10);
        },
      );
    }
  }

  gpuTest('nothing, if a frame needs no second count', async () => {
    const sortDevice = { isNarrow: false };
    const variant = { geometryPrecision: 'f32', culling: 'bounding-box', sortDevice } as const;
    const counts = await countsOf(cells, SHIFT_NONE, variant, undefined, undefined, COUNT_NOTHING);
    expect(new Set(counts)).toEqual(new Set([0]));
  });

  const instances = [
    { side: ABOVE, limits: 0 },
    { side: EVERYWHERE, limits: 70 },
    { side: ABOVE, limits: 300 },
  ];
  const farther = (counted: readonly CountedChunk[], by: number) =>
    counted.map(({ limit, parentLimit, ...chunk }) => ({
      ...chunk,
      limit: limit + by,
      parentLimit: parentLimit === null ? null : parentLimit + by,
    }));
  const everywhere = countedIf(() => true);
  const ofInstances = instances.flatMap(({ side, limits }) =>
    farther(side === ABOVE ? inSight : everywhere, limits),
  );
  for (const isNarrow of [false, true]) {
    gpuTest(`of several instances${isNarrow ? ', on a CPU' : ''}: the sum of what each draws`, async () => {
      const variant = {
        geometryPrecision: 'packed',
        culling: 'bounding-box',
        batchInstances: 5,
        sortDevice: { isNarrow },
      } as const;
      const base = SHIFT_NONE - 500;
      const expected = expectedAt(ofInstances, base);
      expect(await countsOf(cells, base, variant, undefined, instances)).toEqual(expected);
    });
  }

  const faults = [
    [' - links[chunk].uncounted', ''],
    ['head.isWhole = isWithin(center, halfExtent)', 'head.isWhole = true'],
    ['lane >= head.pairs', 'false'],
    [' || isAlwaysDrawn(link)', ''],
    ['page.splatCount - chunk * CHUNK_SPLATS', '0xffffffffu'],
    ['max(cutPlan.base, cutPlan.leastShift)', 'cutPlan.leastShift'],
  ];
  for (const [find, replace] of isFull ? faults : faults.slice(0, 2)) {
    gpuTest(`a fault is noticed: ${replace || 'nothing'} for ${find}`, { tags: 'deeper' }, async () => {
      const sortDevice = { isNarrow: false };
      const variant = { geometryPrecision: 'f32', culling: 'bounding-box', sortDevice } as const;
      const pipelines = new Pipelines(gpu.device, { file: 'stages/cut-count', find, replace });
      const counts = await countsOf(cells, SHIFT_NONE - 500, variant, pipelines);
      expect(counts).not.toEqual(expectedAt(inSight, SHIFT_NONE - 500));
    });
  }
});
