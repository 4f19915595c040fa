import { gpuTest } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { cellCounts, childCell } from '../../data/layout/cell-counts.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { chunkCountOf, maxScaleOf } from '../../data/packing/chunks.ts';
import { packSet } from '../../data/packing/pack-set.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { linkParts } from '../../reference/level-link.ts';
import { type MadeCell, type MadeNode, madeLevels, type TouchedBy } from '../../testing/made-levels.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { touchCell } from './cut.reference.ts';

const { ERROR_BOUNDLESS } = LEVEL_CONSTANTS;
const isFull = process.env.WEBSPLATTER_FULL === '1';
/** More chunks than sixteen, so that there are cells of two levels above them. */
const COUNT = 4400;
const gpu = testGpu();
const packed = packSet(randomSplats({ count: COUNT, seed: 4, shDegree: 0 }), {
  geometryPrecision: 'packed',
  shPrecision: 'f32',
});

const linksOf = (nodes: readonly (MadeNode | undefined)[]) => nodes.map((node) => node?.link ?? 0);

/** Expects links and heads of all cells to be those of `before`, refined as the reference does. */
function expectRefined(
  before: readonly MadeCell[],
  after: readonly MadeCell[],
  { edited = () => false, hidden = () => false, selections = [] }: TouchedBy,
): void {
  const counts = cellCounts(chunkCountOf(COUNT));
  const chunks = new Float32Array(packed.chunks);
  const isTouched: boolean[] = [];
  for (const [i, cell] of before.entries()) {
    const isUpper = i >= counts[0];
    const below = (slot: number) => isTouched[childCell(counts, { cell: i, slot })];
    const leaves = linksOf(cell.leaves).map((link, slot) =>
      isUpper && link !== 0 && below(slot) ? (link | ERROR_BOUNDLESS) >>> 0 : link,
    );
    const ofSplat = (is: (splat: number) => boolean) => (slot: number) => !isUpper && is(256 * i + slot);
    const expected = touchCell(
      { leaves, blobs: linksOf(cell.blobs) },
      (slot) => (isUpper ? below(slot) : [edited, ...selections].some((isSet) => ofSplat(isSet)(slot))),
      ofSplat(hidden),
    );
    isTouched.push(expected.isTouched);
    expect(linksOf(after[i].leaves), `leaves of cell ${i}`).toEqual(expected.leaves);
    expect(linksOf(after[i].blobs), `blobs of cell ${i}`).toEqual(expected.blobs);
    const leastOf = (links: readonly number[]) =>
      Math.min(...links.filter((link) => link !== 0).map((link) => linkParts(link).error));
    const { leafHead, blobHead } = after[i];
    expect([leafHead[2], blobHead[2]]).toEqual([leastOf(expected.leaves), leastOf(expected.blobs)]);
    const largest = expected.isTouched ? ERROR_BOUNDLESS : null;
    expect([leafHead[1], blobHead[1], leafHead[3]]).toEqual([
      largest ?? cell.leafHead[1],
      largest ?? cell.blobHead[1],
      largest ?? cell.leafHead[3],
    ]);
    const [scale, scaleBefore] = [leafHead, cell.leafHead].map(
      (head) => new Float32Array(head.slice().buffer)[4],
    );
    if (!expected.isTouched || isUpper) expect(scale).toBe(scaleBefore);
    else expect(scale / Math.max(scaleBefore, maxScaleOf(chunks, i) / 1.001)).toBeCloseTo(1, 5);
    expect(leafHead[7]).toBe(expected.uncounted);
    expect([leafHead[0], blobHead[0], ...blobHead.slice(3)]).toEqual([
      cell.leafHead[0],
      cell.blobHead[0],
      ...cell.blobHead.slice(3),
    ]);
  }
}

const random = seededRandom(8);
const some = Uint8Array.from({ length: COUNT }, () => 256 * random());
const touchedBy: Record<string, TouchedBy> = {
  nothing: {},
  'one edited splat': { edited: (i) => i === 2600 },
  'the last splat': { edited: (i) => i === COUNT - 1 },
  'edited splats in all cells': { edited: (i) => some[i] < 3 },
  'a selection': { selections: [(i) => i > 3000 && i < 3500] },
  'two selections and edits': {
    edited: (i) => some[i] === 7,
    selections: [(i) => i % 1000 === 0, (i) => i > 3900 && some[i] > 250],
  },
  'hidden splats, with cells of nothing else': {
    edited: (i) => some[i] < 2 || (i >= 512 && i < 1100),
    hidden: (i) => (i < 700 && some[i] < 2) || (i >= 512 && i < 1100),
  },
  'all splats': { edited: () => true },
};

describe('touch-links', () => {
  let before: MadeCell[];
  beforeAll(async () => {
    before = await madeLevels(gpu, packed);
    expect(before.length).toBeGreaterThan(chunkCountOf(COUNT) + 2);
  });

  for (const [name, touched] of Object.entries(touchedBy)) {
    gpuTest(`${name}: as the reference refines`, async () => {
      const after = await madeLevels(gpu, packed, { touched });
      expectRefined(before, after, touched);
      if (name !== 'nothing') return;
      const headsOf = (cells: readonly MadeCell[]) =>
        cells.map(({ leafHead, blobHead }) => [leafHead, blobHead]);
      expect(headsOf(after)).toEqual(headsOf(before));
    });
  }

  gpuTest('a splat with one blob above: as the reference refines', async () => {
    const isRoot = (node: MadeNode) => linkParts(node.link).parentError >= ERROR_BOUNDLESS;
    const splats = before
      .slice(0, chunkCountOf(COUNT))
      .flatMap(({ leaves, blobs }, cell) =>
        leaves.flatMap((leaf, slot) =>
          leaf?.link && isRoot(blobs[linkParts(leaf.link).parentSlot]!) ? 256 * cell + slot : [],
        ),
      );
    expect(splats.length).toBeGreaterThan(0);
    const touched = { edited: (i: number) => i === splats[0] };
    expectRefined(before, await madeLevels(gpu, packed, { touched }), touched);
  });

  gpuTest('pages, and dispatches of any row, make no difference', async () => {
    const options = { touched: touchedBy['two selections and edits'], bytesPerPage: 32 * 256 * 3 };
    expectRefined(before, await madeLevels(gpu, packed, { ...options, dispatchRow: 1 }), options.touched);
  });

  const faults = [
    ['slot = parentSlotOf(link);', 'break;'],
    ['lane < CELL_ROOTS', 'lane < 15u'],
    ['root | ERROR_BOUNDLESS', 'root | 0xffu'],
    ['i * stride + word', 'word'],
    ['(*ofBlobs).cellError = ERROR_BOUNDLESS;', ''],
  ];
  for (const [find, replace] of isFull ? faults : faults.slice(0, 2)) {
    gpuTest(`a fault is noticed: ${replace || 'nothing'} for ${find}`, { tags: 'deeper' }, async () => {
      const pipelines = new Pipelines(gpu.device, { file: 'stages/touch-links', find, replace });
      const touched = touchedBy['two selections and edits'];
      const after = await madeLevels(gpu, packed, { touched, pipelines });
      expect(() => expectRefined(before, after, touched)).toThrow();
    });
  }
});
