import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { binGrid } from '../../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { SortPlan, TilePlan } from '../../data/layout/structs.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { tileUniforms } from '../../testing/tile-buffers.ts';
import { dispatchSize } from '../dispatch.ts';
import { blockKeysOf, pairSortShapeFor } from '../sort/sort.ts';
import { type PairPlan, tilePlan as planReference, wholeShift } from './tiles.reference.ts';
import { tilePlan } from './tiles.ts';

const { MASK_GROUP, TILE_COUNT_BLOCK } = SHADER_CONSTANTS;
const DISPATCH_ROW = 100;
/** Sums stop here. */
const MOST_PAIRS = 2 ** 30;

const gpu = testGpu();

/** 10×8 bins: at a shift of 4, one covers them all. */
const SIZE = { widthPx: 640, heightPx: 480 };
const GRID = binGrid(SIZE.widthPx, SIZE.heightPx);
const WHOLE = wholeShift(GRID);

interface Blocks {
  readonly blockPairs: readonly number[];
  readonly pairCapacity: number;
  /** Ranks of the last block; default as many as it may have. */
  readonly lastRanks?: number;
  /** Pairs of the blocks if they are counted again; default an eighth. */
  readonly recounted?: readonly number[];
}

/** Plans blocks by the GPU and by the reference, and once more as if pairs had been counted again. */
async function check(options: Blocks) {
  const { blockPairs, pairCapacity, lastRanks = TILE_COUNT_BLOCK } = options;
  const { recounted = blockPairs.map((pairs) => Math.floor(pairs / 8)) } = options;
  const shape = pairSortShapeFor(7);
  const visibleCount = Math.max(0, (blockPairs.length - 1) * TILE_COUNT_BLOCK + lastRanks);
  const outputs = {
    tilePlan: gpu.storage([], TilePlan.bytes),
    sortPlan: gpu.storage([], SortPlan.bytes),
    drawArguments: gpu.storage([9, 9, 9, 9]),
    pairDispatches: gpu.storage([], 24),
  };
  const all = {
    ...tileUniforms(gpu, { size: SIZE, alphaCutoff: 1 / 255, pairCapacity, dispatchRow: DISPATCH_ROW }),
    visibleCount: gpu.storage([visibleCount]),
    ...outputs,
  };
  const counts = { visibleCount, pairCapacity, grid: GRID };
  const plan = async (blocks: readonly number[], first?: PairPlan) => {
    const blockBuffer = gpu.storage([...blocks, 1234]);
    await gpu.run(tilePlan(shape, first !== undefined), { ...all, blockPairs: blockBuffer }, [1, 1, 1]);
    const isPlanned = !first || (first.binShift > 0 && first.binShift < WHOLE);
    const reference = isPlanned ? planReference(blocks, { ...counts, ...(first && { first }) }) : first;
    const starts = Array.from(await gpu.read(blockBuffer));
    // The block behind the last is not this frame's.
    expect(starts.pop()).toBe(1234);
    if (!isPlanned) expect(starts).toEqual(blocks);
    // Pairs that do not fit are not listed, so nothing reads where they would begin.
    else if (reference.fits && reference.binShift < WHOLE) expect(starts).toEqual(reference.blockStarts);
    expect(Array.from(await gpu.read(outputs.tilePlan))).toEqual([
      Math.min(reference.neededPairs, MOST_PAIRS),
      reference.pairCount,
      Number(reference.fits),
      visibleCount,
      reference.binShift,
    ]);
    const blockCount = Math.ceil(reference.pairCount / blockKeysOf(shape));
    expect(Array.from(await gpu.read(outputs.sortPlan))).toEqual([reference.pairCount, blockCount]);
    const groupCount = Math.ceil(reference.pairCount / MASK_GROUP);
    expect(Array.from(await gpu.read(outputs.pairDispatches))).toEqual(
      [blockCount, groupCount].flatMap((count) => dispatchSize(count, DISPATCH_ROW)),
    );
    expect(Array.from(await gpu.read(outputs.drawArguments))).toEqual([4, reference.quads, 0, 0]);
    return reference;
  };
  return plan(recounted, await plan(blockPairs));
}

describe('tile-plan', () => {
  gpuTest('pairs that fit exactly, and one too many', async () => {
    const blockPairs = [5000, 0, 7, 12_345];
    expect(await check({ blockPairs, pairCapacity: 17_352 })).toMatchObject({ fits: true, binShift: 0 });
    const larger = await check({ blockPairs, pairCapacity: 17_351 });
    expect(larger).toMatchObject({ fits: true, binShift: 2, pairCount: 625 + 1543 });
  });

  gpuTest('bins of every size', async () => {
    const shifts = new Set<number>();
    for (const pairs of [8000, 8100, 20_000, 100_000, 800_000]) {
      const { fits, binShift } = await check({ blockPairs: [pairs], pairCapacity: 8000, recounted: [5000] });
      expect(fits).toBe(true);
      shifts.add(binShift);
    }
    expect([...shifts]).toEqual([0, 1, 2, 3, WHOLE]);
  });

  gpuTest('larger bins that do not fit either', async () => {
    const blocks = { blockPairs: [30_000], pairCapacity: 8000 };
    const exact = await check({ ...blocks, recounted: [8000] });
    expect(exact).toMatchObject({ fits: true, binShift: 2, pairCount: 8000 });
    const whole = await check({ ...blocks, recounted: [8001], lastRanks: 700 });
    expect(whole).toMatchObject({ fits: true, binShift: WHOLE, pairCount: 700 });
  });

  gpuTest('as many visible splats as there is room for, and one too many', async () => {
    const blocks = { blockPairs: [5000, 0, 7, 12_345], lastRanks: 3 };
    const visible = 3 * 1024 + 3;
    const exact = await check({ ...blocks, pairCapacity: visible });
    expect(exact).toMatchObject({ fits: true, binShift: WHOLE, pairCount: visible });
    const many = await check({ ...blocks, pairCapacity: visible - 1 });
    expect(many).toMatchObject({ fits: false, pairCount: 0, quads: visible });
  });

  gpuTest('no pairs, and no splats', async () => {
    const none = { fits: true, binShift: 0, pairCount: 0 };
    expect(await check({ blockPairs: [0, 0], pairCapacity: 100 })).toMatchObject(none);
    expect(await check({ blockPairs: [], pairCapacity: 100 })).toMatchObject(none);
    expect(await check({ blockPairs: [0], pairCapacity: 0, lastRanks: 1 })).toMatchObject(none);
  });

  gpuTest('more blocks than threads', async () => {
    const random = seededRandom(1);
    for (const count of [255, 256, 257, 700]) {
      const blockPairs = Array.from({ length: count }, () => Math.floor(3000 * random()));
      const found = await check({ blockPairs, pairCapacity: 2 ** 24, lastRanks: 17 });
      expect(found).toMatchObject({ fits: true, binShift: 0 });
    }
  });

  gpuTest('sums beyond 32 bits do not wrap around to ones that fit', async () => {
    const pairCapacity = 2 ** 26;
    const recounted = [5];
    // Of one round of the scan, of several, and of single blocks whose own sums stopped.
    for (const blockPairs of [
      Array<number>(64).fill(pairCapacity),
      Array<number>(1024).fill(2 ** 22),
      [1, MOST_PAIRS, MOST_PAIRS, MOST_PAIRS, MOST_PAIRS],
    ]) {
      const blocks = { blockPairs, pairCapacity, recounted: blockPairs.map(() => recounted[0]) };
      expect((await check(blocks)).binShift).toBeGreaterThan(0);
    }
  });
});
