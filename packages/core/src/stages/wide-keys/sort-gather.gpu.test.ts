import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SortParameters } from '../../data/layout/structs.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { createSortDevice, sortLimitsOf } from '../../testing/sort-device.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { blockKeysOf, sortShapeFor } from '../sort/sort.ts';
import { sortGather as gatherReference } from './wide-keys.reference.ts';
import { sortGather } from './wide-keys.ts';

const gpu = testGpu(createSortDevice);

describe('sort-gather', () => {
  gpuTest('takes the upper words as the reference does, and writes nothing behind them', async () => {
    const random = seededRandom(4);
    const devices = [
      ...sortLimitsOf(gpu.device).map((workgroupBytes) => ({ workgroupBytes })),
      { isNarrow: true },
    ];
    for (const shape of devices.map((device) => sortShapeFor(64, device))) {
      const blockKeys = blockKeysOf(shape);
      for (const [count, dispatchRow] of [
        [1, 65_535],
        [blockKeys, 65_535],
        [9 * blockKeys + 17, 7],
      ]) {
        const upperKeys = Uint32Array.from({ length: count }, () => random() * 2 ** 32);
        const payloads = Uint32Array.from({ length: count }, () => random() * count);
        const room = { digitShift: 0, capacity: count, makesPayloads: 0, writesKeys: 0, scanLanes: 0 };
        const keys = gpu.storage(new Uint32Array(count + 100).fill(99));
        const blockCount = Math.ceil(count / blockKeys);
        const bindings = {
          parameters: gpu.uniform(SortParameters.pack({ ...room, dispatchRow })),
          plan: gpu.storage([count, blockCount]),
          upperKeys: gpu.storage(upperKeys),
          payloads: gpu.storage(payloads),
          keys,
        };
        await gpu.run(sortGather(shape), bindings, dispatchSize(blockCount, dispatchRow));
        const written = await gpu.read(keys);
        expect(written.subarray(0, count)).toEqual(gatherReference(upperKeys, payloads));
        expect(written.subarray(count)).toEqual(new Uint32Array(100).fill(99));
      }
    }
  });
});
