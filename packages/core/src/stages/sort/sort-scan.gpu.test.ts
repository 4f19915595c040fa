import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SCAN_RUN } from '../../data/layout/constants.ts';
import { SortParameters } from '../../data/layout/structs.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { sortScan as scanReference } from './sort.reference.ts';
import { scanLanesFor, scanWorkgroups, sortScan } from './sort.ts';

const gpu = testGpu();

const BEHIND = 0xdeadbeef;

/** Scans counts on the GPU and by the reference; words after counts and totals must not change. */
async function scan(
  counts: Uint32Array,
  digitBits: number,
  options: { maxBlocks?: number; row?: number; isNarrow?: boolean } = {},
) {
  const radix = 2 ** digitBits;
  const blockCount = counts.length / radix;
  const { maxBlocks = blockCount, row: dispatchRow = 65_535, isNarrow = false } = options;
  const scanLanes = scanLanesFor(maxBlocks, isNarrow);
  const digitCounts = gpu.storage([...counts, BEHIND]);
  const digitTotals = gpu.storage(new Uint32Array(radix + 1).fill(BEHIND));
  const pass = { digitShift: 0, makesPayloads: 0, writesKeys: 0, scanLanes };
  const bindings = {
    parameters: gpu.uniform(SortParameters.pack({ ...pass, capacity: 0, dispatchRow })),
    plan: gpu.storage([0, blockCount]),
    digitCounts,
    digitTotals,
  };
  // Workgroups behind the last digit must do nothing.
  const workgroups = dispatchSize(scanWorkgroups({ digitBits }, scanLanes) + 5, dispatchRow);
  await gpu.run(sortScan({ digitBits }), bindings, workgroups);
  const reference = scanReference(counts, digitBits);
  return {
    actual: { offsets: await gpu.read(digitCounts), totals: await gpu.read(digitTotals) },
    expected: {
      offsets: Uint32Array.of(...reference.digitOffsets, BEHIND),
      totals: Uint32Array.of(...reference.digitTotals, BEHIND),
    },
  };
}

function randomCounts(digitBits: number, blockCount: number): Uint32Array {
  const random = seededRandom(blockCount);
  return Uint32Array.from({ length: blockCount << digitBits }, () => Math.floor(300 * random()));
}

describe('sort-scan', () => {
  for (const digitBits of [1, 8, 9]) {
    gpuTest(`digits of ${digitBits} bits: the reference's sums for few blocks`, async () => {
      for (const blockCount of [0, 1, 2, 7, 8, 9, 63, 64, 65]) {
        for (const row of [3, 65_535]) {
          const { actual, expected } = await scan(randomCounts(digitBits, blockCount), digitBits, { row });
          expect(actual).toEqual(expected);
        }
      }
    });
  }

  gpuTest('any number of blocks', async () => {
    for (const blockCount of [66, 127, 128, 129, 256, 257, 1000, SCAN_RUN, SCAN_RUN + 1, 3 * SCAN_RUN + 5]) {
      for (const isNarrow of [false, true]) {
        const { actual, expected } = await scan(randomCounts(2, blockCount), 2, { isNarrow });
        expect(actual, `${blockCount} blocks, ${isNarrow ? 'one thread' : 'threads together'}`).toEqual(
          expected,
        );
      }
    }
  });

  gpuTest('any number of threads per digit, for more or fewer blocks than they take at a time', async () => {
    for (const maxBlocks of [1, 100, 200, 500, 1000, 2000]) {
      for (const blockCount of [3, 300, SCAN_RUN + 1]) {
        const { actual, expected } = await scan(randomCounts(3, blockCount), 3, { maxBlocks });
        expect(actual, `${blockCount} blocks, ${scanLanesFor(maxBlocks, false)} threads`).toEqual(expected);
      }
    }
  });

  gpuTest('sums wrap at 2^32 as the reference does', async () => {
    const { actual, expected } = await scan(new Uint32Array(4 * SCAN_RUN).fill(0x80000001), 1);
    expect(actual).toEqual(expected);
  });
});
