import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { ChunkLinks, CutPlan, LEVEL_CONSTANTS, LevelCell } from '../../data/layout/level-structs.ts';
import { Chunk } from '../../data/layout/structs.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { type CountedChunk, cutCount as reference } from '../../reference/cut-count.ts';
import { packFlatPage, packFlatView } from '../../testing/flat-view.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { countWorkgroups, cutCount } from './cut-count.ts';
import { dispatchSize } from './dispatch.ts';

const { CUT_BINS, CUT_COPIES, ERROR_BOUNDLESS, NO_CELL, SHIFT_NONE, SHIFT_STEP } = LEVEL_CONSTANTS;
const DISPATCH_ROW = 4;
const CHUNKS = 30;
const gpu = testGpu();

/**
 * Chunks of cells, each below the one before it, at x = cell; of every three one is out of sight,
 * and of one every second node.
 */
function randomChunks() {
  const random = seededRandom(9);
  const below = (end: number) => Math.floor(random() * end);
  const limits = [0];
  while (limits.length < CHUNKS) limits.push(limits.at(-1)! + below(100));
  const cells = limits.map((limit, cell) => {
    const parent = cell === 0 ? NO_CELL : cell - 1;
    const links = Array.from({ length: CHUNK_SPLATS }, () => {
      const error = below(3) === 0 ? 0 : below(2500);
      const parentError = below(9) === 0 ? ERROR_BOUNDLESS : error + 1 + below(1500);
      return below(10) === 0 ? 0 : error + parentError * 2 ** 12 + below(256) * 2 ** 24;
    });
    const isInSight = (slot: number) => cell % 3 === 0 || (cell % 3 === 1 && slot % 2 === 1);
    return { limit, parent, cellError: below(3000), links, isInSight };
  });
  return cells;
}

async function countsOf(
  cells: ReturnType<typeof randomChunks>,
  base: number,
  step: number,
  variant: Parameters<typeof cutCount>[0],
) {
  const contents = new ArrayBuffer(CHUNKS * LevelCell.bytes);
  const words = GEOMETRY_WORDS[variant.geometryPrecision];
  const geometry = new Float32Array(CHUNKS * CHUNK_SPLATS * words);
  for (const [i, { parent, isInSight }] of cells.entries()) {
    const y = Array.from({ length: CHUNK_SPLATS }, (_, slot) => (isInSight(slot) ? 0 : -100));
    const minPosition = [i, Math.min(...y), 0];
    const maxPosition = [i + 1, Math.max(...y), 1];
    LevelCell.write(contents, { minPosition, maxPosition, parent }, i * LevelCell.bytes);
    for (const [slot, at] of y.entries()) geometry.set([i, at, 0], (i * CHUNK_SPLATS + slot) * words);
  }
  const linkWords = cells.flatMap(({ cellError, links }, cell) => {
    const used = links.filter((link) => link !== 0);
    const leastError = Math.min(...used.map((link) => link & 0xfff));
    const largestParentError = Math.max(...used.map((link) => (link >>> 12) & 0xfff));
    return [cell, cellError, leastError, largestParentError, 0, used.length, ...links];
  });
  expect(linkWords.length).toBe(CHUNKS * ChunkLinks.words);
  const cutCounts = gpu.storage([], 4 * CUT_BINS * CUT_COPIES);
  const bindings = {
    view: gpu.uniform(
      packFlatView({ size: { widthPx: 1, heightPx: 1 }, alphaCutoff: 0, dispatchRow: DISPATCH_ROW }),
    ),
    // All sides are the half-space above y = -10.
    page: gpu.uniform(packFlatPage(0, CHUNKS, [0, 1, 0, 10])),
    links: gpu.storage(linkWords),
    cells: gpu.storage(new Uint32Array(contents)),
    thresholds: gpu.storage(cells.map(({ limit }) => limit)),
    cutPlan: gpu.storage(new Uint32Array(CutPlan.pack({ base, step, shift: 0, budget: 0 }))),
    cutCounts,
    geometry: gpu.storage(new Uint32Array(geometry.buffer)),
    chunks: gpu.storage([], Chunk.bytes * CHUNKS),
  };
  await gpu.run(cutCount(variant), bindings, dispatchSize(countWorkgroups(CHUNKS) + 1, DISPATCH_ROW));
  const changes = await gpu.read(cutCounts);
  let sum = 0;
  return Array.from({ length: CUT_BINS }, (_, bin) => {
    for (let copy = 0; copy < CUT_COPIES; copy++) sum = (sum + changes[copy * CUT_BINS + bin]) >>> 0;
    return sum;
  });
}

describe('cut-count', () => {
  const cells = randomChunks();
  const countedIf = (isCounted: (cell: number, slot: number) => boolean) =>
    cells.map(
      ({ limit, parent, cellError, links }, cell): CountedChunk => ({
        limit,
        parentLimit: parent === NO_CELL ? null : cells[parent].limit,
        cellError,
        links: links.filter((_, slot) => isCounted(cell, slot)),
      }),
    );
  const inSight = countedIf((cell, slot) => cells[cell].isInSight(slot));
  const ofChunks = countedIf((cell) => cell % 3 !== 2);
  for (const [base, step] of [
    [0, SHIFT_STEP],
    [SHIFT_NONE, SHIFT_STEP],
    [SHIFT_NONE - 1500, 1],
    [SHIFT_NONE + 700, 1],
  ]) {
    for (const [geometryPrecision, culling, counted] of [
      ['f32', 'bounding-box', inSight],
      ['packed', 'bounding-box', inSight],
      ['packed', 'frustum', ofChunks],
    ] as const) {
      gpuTest(
        `${geometryPrecision}, ${culling}: what is drawn at shifts from ${base} by ${step}`,
        async () => {
          const expected = Array.from({ length: CUT_BINS }, (_, bin) =>
            reference(counted, base + step * bin),
          );
          expect(await countsOf(cells, base, step, { geometryPrecision, culling })).toEqual(expected);
          expect(new Set(expected).size).toBeGreaterThan(10);
        },
      );
    }
  }
});
