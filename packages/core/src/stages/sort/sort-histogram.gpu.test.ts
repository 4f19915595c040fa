import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SortParameters } from '../../data/layout/structs.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { createSortDevice, sortLimitsOf } from '../../testing/sort-device.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { sortHistogram as histogramReference } from './sort.reference.ts';
import { blockKeysOf, sortHistogram, sortShapeFor } from './sort.ts';

const gpu = testGpu(createSortDevice);

describe('sort-histogram', () => {
  gpuTest('counts the digits of each block as the reference does, in every pass', async () => {
    const random = seededRandom(3);
    const devices = [
      ...sortLimitsOf(gpu.device).map((workgroupBytes) => ({ workgroupBytes })),
      { isNarrow: true },
    ];
    const shapes = devices.flatMap((device) => [24, 27, 32].map((bits) => sortShapeFor(bits, device)));
    for (const shape of shapes) {
      const bits = shape.digitBits * shape.passes;
      const blockKeys = blockKeysOf(shape);
      for (const [count, dispatchRow] of [
        [1, 65_535],
        [blockKeys, 65_535],
        [9 * blockKeys + 17, 7],
      ]) {
        // Garbage after the keys must not be counted.
        const keys = Uint32Array.from({ length: count + 100 }, () => random() * 2 ** bits);
        const blockCount = Math.ceil(count / blockKeys);
        const radix = 1 << shape.digitBits;
        for (let pass = 0; pass < shape.passes; pass++) {
          const digitShift = pass * shape.digitBits;
          const parameters = SortParameters.pack({
            digitShift,
            capacity: keys.length,
            dispatchRow,
            makesPayloads: 0,
            writesKeys: 0,
            scanLanes: 0,
          });
          const digitCounts = gpu.storage(new Uint32Array(radix * blockCount).fill(99));
          const bindings = {
            parameters: gpu.uniform(parameters),
            plan: gpu.storage([count, blockCount]),
            keys: gpu.storage(keys),
            digitCounts,
          };
          await gpu.run(sortHistogram(shape), bindings, dispatchSize(blockCount, dispatchRow));
          const expected = histogramReference(keys.subarray(0, count), {
            digitShift,
            digitBits: shape.digitBits,
            blockKeys,
          });
          expect(await gpu.read(digitCounts)).toEqual(expected);
        }
      }
    }
  });
});
