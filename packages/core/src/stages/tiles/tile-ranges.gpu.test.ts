import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { binGrid } from '../../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { TilePlan } from '../../data/layout/structs.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { tileUniforms } from '../../testing/tile-buffers.ts';
import { tileRanges as rangesReference } from './tiles.reference.ts';
import { tileRanges } from './tiles.ts';

const { BIN_PX } = SHADER_CONSTANTS;

const gpu = testGpu();

/** Number of pairs up to which two lists count as equally long: four steps per power of two. */
function lengthClass(length: number): number {
  if (length === 0) return -1;
  const exponent = Math.floor(Math.log2(length));
  return 4 * exponent + Math.floor(4 * (length / 2 ** exponent - 1));
}

/** Divides the pairs of bins with these numbers of pairs, and `leftover` pairs behind all bins. */
async function check(lengths: readonly number[], binColumns: number, leftover = 0): Promise<void> {
  const binCount = lengths.length;
  const size = { widthPx: BIN_PX * binColumns - 5, heightPx: BIN_PX * (binCount / binColumns) };
  expect(binGrid(size.widthPx, size.heightPx)).toEqual({ binColumns, binRows: binCount / binColumns });
  const bins = [...lengths, leftover].flatMap((length, bin) => Array<number>(length).fill(bin));
  const pairCount = bins.length;
  const plan = TilePlan.pack({ neededPairs: pairCount, pairCount, fits: 1, visibleCount: 1, binShift: 0 });
  const binStarts = gpu.storage(Array<number>(binCount + 2).fill(77));
  const binOrder = gpu.storage(Array<number>(binCount + 1).fill(77));
  const bindings = {
    grid: tileUniforms(gpu, { size, alphaCutoff: 1 / 255 }).grid,
    tilePlan: gpu.storage(new Uint32Array(plan)),
    // Keys of an earlier frame lie behind this frame's.
    sortedBins: gpu.storage([...bins, 0, 1, 2]),
    binStarts,
    binOrder,
  };
  await gpu.run(tileRanges, bindings, [1, 1, 1]);
  const starts = Array.from(await gpu.read(binStarts));
  expect(starts).toEqual([...rangesReference(bins, binCount), 77]);
  const order = Array.from(await gpu.read(binOrder));
  expect(order.pop()).toBe(77);
  expect(order.toSorted((a, b) => a - b)).toEqual(lengths.map((_, bin) => bin));
  const classes = order.map((bin) => lengthClass(lengths[bin]));
  expect(classes).toEqual(classes.toSorted((a, b) => b - a));
}

describe('tile-ranges', () => {
  gpuTest('bins of all lengths, empty ones in between, with leftover pairs behind the last', async () => {
    await check([3, 0, 0, 17, 1, 4, 2, 0, 1000, 40, 41, 0], 4, 9);
    await check([0, 0, 5, 0, 0, 0], 3);
    await check([0, 5], 2, 1);
  });

  gpuTest('no pairs at all, and only leftover ones', async () => {
    await check([0, 0, 0, 0], 2);
    await check([0, 0], 1, 30);
    await check([0], 1);
  });

  gpuTest('a single bin with all pairs', async () => {
    await check([0, 70_000, 0], 3);
    await check([4097], 1);
  });

  gpuTest('more bins than threads', async () => {
    const random = seededRandom(6);
    for (const [columns, rows] of [
      [16, 16],
      [257, 1],
      [30, 20],
    ]) {
      const lengths = Array.from({ length: columns * rows }, () => Math.floor(random() ** 6 * 800));
      await check(lengths, columns, 5);
    }
  });
});
