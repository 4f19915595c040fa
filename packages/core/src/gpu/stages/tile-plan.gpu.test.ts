import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { SortPlan, TilePlan } from '../../data/layout/structs.ts';
import { tilePlan as planReference } from '../../reference/tile-plan.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { tileUniforms } from '../../testing/tile-buffers.ts';
import { blockKeysOf, pairSortShapeFor } from './sort-shape.ts';
import { tilePlan } from './tile-plan.ts';

const { TILE_COUNT_BLOCK } = SHADER_CONSTANTS;
/** Sums stop here. */
const MOST_PAIRS = 2 ** 30;

const gpu = testGpu();

/** Plans these blocks, of which the last has `lastRanks` ranks, by the GPU and by the reference. */
async function check(
  blockPairs: readonly number[],
  pairCapacity: number,
  lastRanks: number = TILE_COUNT_BLOCK,
) {
  const shape = pairSortShapeFor(7);
  const visibleCount = Math.max(0, (blockPairs.length - 1) * TILE_COUNT_BLOCK + lastRanks);
  const blocks = gpu.storage([...blockPairs, 1234]);
  const outputs = {
    tilePlan: gpu.storage([], TilePlan.bytes),
    sortPlan: gpu.storage([], SortPlan.bytes),
    drawArguments: gpu.storage([9, 9, 9, 9]),
  };
  const size = { widthPx: 640, heightPx: 480 };
  const bindings = {
    grid: tileUniforms(gpu, { size, alphaCutoff: 1 / 255, pairCapacity }).grid,
    visibleCount: gpu.storage([visibleCount]),
    blockPairs: blocks,
    ...outputs,
  };
  await gpu.run(tilePlan(shape), bindings, [1, 1, 1]);
  const reference = planReference(blockPairs, visibleCount, pairCapacity);
  const starts = Array.from(await gpu.read(blocks));
  // The block behind the last is not this frame's.
  expect(starts.pop()).toBe(1234);
  // Pairs that do not fit are not listed, so nothing reads where they would begin.
  if (reference.fits) expect(starts).toEqual(reference.blockStarts);
  expect(Array.from(await gpu.read(outputs.tilePlan))).toEqual([
    Math.min(reference.neededPairs, MOST_PAIRS),
    reference.pairCount,
    Number(reference.fits),
    visibleCount,
  ]);
  const blockCount = Math.ceil(reference.pairCount / blockKeysOf(shape));
  expect(Array.from(await gpu.read(outputs.sortPlan))).toEqual([reference.pairCount, blockCount]);
  expect(Array.from(await gpu.read(outputs.drawArguments))).toEqual([4, reference.quads, 0, 0]);
  return reference;
}

describe('tile-plan', () => {
  gpuTest('pairs that fit exactly, and one too many', async () => {
    const blockPairs = [5000, 0, 7, 12_345];
    expect(await check(blockPairs, 17_352)).toMatchObject({ fits: true, quads: 0 });
    expect(await check(blockPairs, 17_351, 3)).toMatchObject({ fits: false, quads: 3 * 1024 + 3 });
  });

  gpuTest('no pairs, and no splats', async () => {
    expect(await check([0, 0], 100)).toMatchObject({ fits: true, pairCount: 0 });
    expect(await check([], 100)).toMatchObject({ fits: true, pairCount: 0 });
    expect(await check([0], 0, 1)).toMatchObject({ fits: true });
  });

  gpuTest('more blocks than threads', async () => {
    const random = seededRandom(1);
    for (const count of [255, 256, 257, 700]) {
      const blockPairs = Array.from({ length: count }, () => Math.floor(3000 * random()));
      expect(await check(blockPairs, 2 ** 24, 17)).toMatchObject({ fits: true });
    }
  });

  gpuTest('sums beyond 32 bits do not wrap around to ones that fit', async () => {
    const pairs = 2 ** 26;
    // Of one round of the scan, of several, and of single blocks whose own sums stopped.
    await check(Array<number>(64).fill(pairs), pairs);
    await check(Array<number>(1024).fill(2 ** 22), pairs);
    const reference = await check([1, MOST_PAIRS, MOST_PAIRS, MOST_PAIRS, MOST_PAIRS], pairs);
    expect(reference.neededPairs).toBeGreaterThan(2 ** 32);
    expect(reference.fits).toBe(false);
  });
});
