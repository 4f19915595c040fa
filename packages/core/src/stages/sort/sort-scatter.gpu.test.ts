import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SortParameters } from '../../data/layout/structs.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { createSortDevice, sortLimitsOf } from '../../testing/sort-device.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import {
  sortHistogram as histogramReference,
  sortScatter as scatterReference,
  sortScan,
} from './sort.reference.ts';
import { blockKeysOf, type SortDevice, sortScatter, sortShapeFor } from './sort.ts';

const gpu = testGpu(createSortDevice);

/** Keys of `bits` bits, and their payloads, in one pass by the GPU and by the reference. */
async function scatter(options: {
  readonly bits: number;
  readonly device: Partial<SortDevice>;
  readonly makesPayloads: boolean;
  readonly writesKeys: boolean;
  readonly countOf: (blockKeys: number) => number;
}) {
  const { bits, device, makesPayloads, writesKeys } = options;
  const random = seededRandom(4);
  const shape = sortShapeFor(bits, device);
  const { digitBits } = shape;
  const blockKeys = blockKeysOf(shape);
  const dispatchRow = 2;
  const count = options.countOf(blockKeys);
  const pass = { digitShift: digitBits, digitBits, blockKeys };
  // Few digits in the first half, so that counts within a block are large; all in the second.
  const keys = Uint32Array.from(
    { length: count },
    (_, i) => random() * (i < count / 2 ? 2 ** (digitBits + 2) : 2 ** bits),
  );
  const payloads = Uint32Array.from(keys, () => Math.floor(random() * 2 ** 32));
  const blockCount = Math.ceil(count / blockKeys);
  const places = sortScan(histogramReference(keys, pass), digitBits);
  const parameters = SortParameters.pack({
    digitShift: pass.digitShift,
    capacity: count,
    dispatchRow,
    makesPayloads: Number(makesPayloads),
    writesKeys: Number(writesKeys),
    scanLanes: 0,
  });
  const keysOut = gpu.storage([], 4 * count);
  const payloadsOut = gpu.storage([], 4 * count);
  const bindings = {
    parameters: gpu.uniform(parameters),
    plan: gpu.storage([count, blockCount]),
    digitOffsets: gpu.storage(places.digitOffsets),
    digitTotals: gpu.storage(places.digitTotals),
    keysIn: gpu.storage(keys),
    payloadsIn: gpu.storage(payloads),
    payloadsOut,
    keysOut,
  };
  // Workgroups behind the last block must do nothing.
  const workgroups = dispatchSize(blockCount + 3, dispatchRow);
  await gpu.run(sortScatter(shape), bindings, workgroups);
  const taken = makesPayloads ? keys.map((_, i) => i) : payloads;
  const reference = scatterReference(keys, taken, places, pass);
  return {
    actual: { keys: await gpu.read(keysOut), payloads: await gpu.read(payloadsOut) },
    expected: { ...reference, keys: writesKeys ? reference.keys : new Uint32Array(count) },
  };
}

/** One for each shape of blocks. */
function sortDevices(): Partial<SortDevice>[] {
  return [...sortLimitsOf(gpu.device).map((workgroupBytes) => ({ workgroupBytes })), { isNarrow: true }];
}

describe('sort-scatter', () => {
  for (const [bits, makesPayloads, writesKeys] of [
    [24, true, true],
    [24, false, true],
    [24, false, false],
    [16, true, false],
    [27, false, true],
  ] as const) {
    const payloads = makesPayloads ? 'makes payloads' : 'reads payloads';
    const name = `${bits} bits, ${payloads}, ${writesKeys ? 'writes' : 'drops'} keys`;
    gpuTest(`${name}: moves keys and payloads to the reference's places`, async () => {
      for (const device of sortDevices()) {
        const countOf = (blockKeys: number) => 3 * blockKeys + 1234;
        const { actual, expected } = await scatter({ bits, device, makesPayloads, writesKeys, countOf });
        expect(actual.payloads, JSON.stringify(device)).toEqual(expected.payloads);
        expect(actual.keys, JSON.stringify(device)).toEqual(expected.keys);
      }
    });
  }

  gpuTest('blocks with any number of keys', async () => {
    for (const countOf of [() => 1, () => 17, (full: number) => full - 1, (full: number) => full, () => 0]) {
      for (const device of sortDevices()) {
        const options = { bits: 24, device, makesPayloads: false, writesKeys: true, countOf };
        const { actual, expected } = await scatter(options);
        expect(actual.payloads.subarray(0, expected.payloads.length)).toEqual(expected.payloads);
        expect(actual.keys.subarray(0, expected.keys.length)).toEqual(expected.keys);
      }
    }
  });
});
