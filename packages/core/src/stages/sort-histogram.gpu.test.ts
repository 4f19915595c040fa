import { createTestDevice, gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { Pipelines } from '../gpu/pipelines.ts';
import { readWords } from '../gpu/read-buffer.ts';
import { SortParameters } from '../layout/structs.ts';
import { sortHistogram as histogramTwin } from '../reference/sort-histogram.ts';
import { runStage, storageBuffer, uniformBuffer } from '../testing/gpu-buffers.ts';
import { seededRandom } from '../testing/seeded-random.ts';
import { dispatchSize } from './dispatch.ts';
import { sortHistogram } from './sort-histogram.ts';
import { sortShapeFor } from './sort-shape.ts';

describe('sort-histogram', () => {
  gpuTest('counts the digits of each tile as the twin does, in every pass', async () => {
    const device = await createTestDevice();
    const pipelines = new Pipelines(device);
    const random = seededRandom(3);
    for (const bits of [24, 27, 32]) {
      const shape = sortShapeFor(bits);
      const tileKeys = shape.workgroup * shape.itemsPerThread;
      for (const [count, dispatchRow] of [
        [1, 65_535],
        [tileKeys, 65_535],
        [9 * tileKeys + 17, 7],
      ]) {
        // Garbage after the keys must not be counted.
        const keys = Uint32Array.from({ length: count + 100 }, () => random() * 2 ** bits);
        const tileCount = Math.ceil(count / tileKeys);
        const radix = 1 << shape.digitBits;
        for (let pass = 0; pass < shape.passes; pass++) {
          const digitShift = pass * shape.digitBits;
          const parameters = SortParameters.pack({
            digitShift,
            radix,
            capacity: keys.length,
            dispatchRow,
            isFirst: 0,
            isLast: 0,
          });
          const digitCounts = storageBuffer(device, new Uint32Array(radix * tileCount).fill(99));
          const bindings = {
            parameters: uniformBuffer(device, parameters),
            plan: storageBuffer(device, [count, tileCount]),
            keys: storageBuffer(device, keys),
            digitCounts,
          };
          await runStage(
            device,
            pipelines,
            sortHistogram(shape),
            bindings,
            dispatchSize(tileCount, dispatchRow),
          );
          const expected = histogramTwin(keys.subarray(0, count), {
            digitShift,
            digitBits: shape.digitBits,
            tileKeys,
          });
          expect(await readWords(device, digitCounts)).toEqual(expected);
        }
      }
    }
    device.destroy();
  });
});
