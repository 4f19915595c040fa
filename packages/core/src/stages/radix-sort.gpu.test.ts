import { createNodeGpu } from '@websplatter/node';
import { createTestDevice, gpuTest } from '@websplatter/node/gpu-test';
import fc from 'fast-check';
import { beforeAll, describe, expect } from 'vitest';
import { GpuMemory } from '../gpu/gpu-memory.ts';
import { Pipelines } from '../gpu/pipelines.ts';
import { readWords } from '../gpu/read-buffer.ts';
import { orderFlaw } from '../inspect/compare-order.ts';
import { radixSort } from '../reference/radix-sort.ts';
import { storageBuffer } from '../testing/gpu-buffers.ts';
import { seededRandom } from '../testing/seeded-random.ts';
import { RadixSort, radixSortStages } from './radix-sort.ts';
import { type SortShape, sortShapeFor } from './sort-shape.ts';

let device: GPUDevice;
let pipelines: Pipelines;

/** Number of workgroups that every device takes in one dimension of a dispatch. */
const MAX_ROW = 65_535;

/** Every shape that frames use, by the number of bits in which its keys may differ. */
const KEY_BITS = [8, 16, 20, 24, 27, 32];

beforeAll(async () => {
  device = await createTestDevice();
  pipelines = new Pipelines(device);
  await pipelines.prepare(KEY_BITS.flatMap((bits) => radixSortStages(sortShapeFor(bits))));
});

/** Sorts in a buffer with room for `capacity` keys, with garbage after the given ones. */
async function sortOnGpu(keys: Uint32Array, shape: SortShape, capacity = keys.length, dispatchRow = MAX_ROW) {
  const memory = new GpuMemory(device);
  const keyCount = storageBuffer(device, [keys.length]);
  const sort = new RadixSort(device, pipelines, memory, { shape, capacity, keyCount, dispatchRow });
  const filled = new Uint32Array(capacity).fill(0x12345678);
  filled.set(keys);
  device.queue.writeBuffer(sort.keys, 0, filled);
  const encoder = device.createCommandEncoder();
  const pass = encoder.beginComputePass();
  sort.record(pass);
  pass.end();
  device.queue.submit([encoder.finish()]);
  const order = (await readWords(device, sort.order)).subarray(0, keys.length);
  sort.destroy();
  keyCount.destroy();
  expect(memory.report().totalBytes).toBe(0);
  return order;
}

/** Keys below 2^bits, by name of their pattern. */
const PATTERNS: Readonly<Record<string, (count: number, bits: number) => (i: number) => number>> = {
  random: (count, bits) => {
    const random = seededRandom(count + bits);
    return () => random() * 2 ** bits;
  },
  sorted: (count, bits) => (i) => (i / count) * 2 ** bits,
  reversed: (count, bits) => (i) => ((count - 1 - i) / count) * 2 ** bits,
  'all equal': (_, bits) => () => 2 ** bits - 1,
  'one differs': (count, bits) => (i) => (i === count >> 1 ? 0 : 2 ** bits - 1),
  sawtooth: () => (i) => i % 200,
  'only the top digit differs': (_, bits) => (i) => (((i * 2654435761) % 256) + 0.3) * 2 ** (bits - 8),
};

function keysOf(pattern: string, count: number, bits: number): Uint32Array {
  const keyAt = PATTERNS[pattern](count, bits);
  return Uint32Array.from({ length: count }, (_, i) => Math.floor(keyAt(i)));
}

describe('radix sort', () => {
  for (const bits of KEY_BITS) {
    const shape = sortShapeFor(bits);
    const tileKeys = shape.workgroup * shape.itemsPerThread;
    const name = `${bits} bits, ${shape.passes} passes of ${shape.digitBits}`;

    gpuTest(`${name}: any number of random keys`, async () => {
      for (const count of [0, 1, 2, 255, 256, 257, tileKeys - 1, tileKeys, tileKeys + 1, 100_000]) {
        const keys = keysOf('random', count, bits);
        const order = await sortOnGpu(keys, shape);
        expect(orderFlaw(keys, order), `${count} keys`).toBeNull();
        if (count <= tileKeys + 1) expect(order).toEqual(radixSort(keys, { ...shape, tileKeys }));
      }
    });

    gpuTest(`${name}: every pattern`, async () => {
      for (const pattern of Object.keys(PATTERNS)) {
        const keys = keysOf(pattern, 2 * tileKeys + 333, bits);
        expect(orderFlaw(keys, await sortOnGpu(keys, shape)), pattern).toBeNull();
      }
    });

    gpuTest(`${name}: a stable permutation for any keys`, async () => {
      const key = fc.oneof(
        fc.nat({ max: 3 }),
        fc.integer({ min: 0, max: 2 ** bits - 1 }),
        fc.nat({ max: 255 }).map((digit) => digit * 2 ** (bits - 8)),
      );
      await fc.assert(
        fc.asyncProperty(
          fc.array(key, { maxLength: 3000, size: 'max' }),
          fc.nat({ max: 5000 }),
          async (values, room) => {
            const keys = Uint32Array.from(values);
            const order = await sortOnGpu(keys, shape, keys.length + room);
            expect(orderFlaw(keys, order)).toBeNull();
          },
        ),
        { numRuns: 8, seed: 5 },
      );
    });

    gpuTest(`${name}: rows of 7 workgroups, and room for more keys`, async () => {
      const keys = keysOf('random', 9 * tileKeys + 1, bits);
      expect(orderFlaw(keys, await sortOnGpu(keys, shape, 12 * tileKeys, 7))).toBeNull();
    });
  }

  gpuTest('a million keys (full mode)', async ({ skip }) => {
    if (!process.env.WEBSPLATTER_FULL) skip('set WEBSPLATTER_FULL=1');
    for (const bits of [27, 32]) {
      for (const pattern of ['random', 'sawtooth', 'reversed']) {
        const keys = keysOf(pattern, 1_000_000, bits);
        expect(
          orderFlaw(keys, await sortOnGpu(keys, sortShapeFor(bits))),
          `${pattern}, ${bits} bits`,
        ).toBeNull();
      }
    }
  });

  gpuTest('more tiles than one dimension of a dispatch takes, at true size (full mode)', async ({ skip }) => {
    const { adapter, isSoftware } = await createNodeGpu();
    if (!process.env.WEBSPLATTER_FULL) skip('set WEBSPLATTER_FULL=1');
    if (isSoftware) skip('needs a GPU: minutes and gigabytes in software');
    const shape = sortShapeFor(32);
    const count = (MAX_ROW + 1) * shape.workgroup * shape.itemsPerThread + 1;
    const { maxBufferSize, maxStorageBufferBindingSize } = adapter.limits;
    if (maxStorageBufferBindingSize < 4 * count) skip(`needs bindings of ${4 * count} bytes`);
    device = await createTestDevice({ requiredLimits: { maxBufferSize, maxStorageBufferBindingSize } });
    pipelines = new Pipelines(device);
    await pipelines.prepare(radixSortStages(shape));
    const keys = keysOf('random', count, 32);
    expect(orderFlaw(keys, await sortOnGpu(keys, shape))).toBeNull();
  });

  gpuTest('the checker finds a swapped pair, a lost key and an unstable pair', () => {
    const keys = Uint32Array.of(5, 1, 5, 3);
    expect(orderFlaw(keys, Uint32Array.of(1, 3, 0, 2))).toBeNull();
    expect(orderFlaw(keys, Uint32Array.of(3, 1, 0, 2))).not.toBeNull();
    expect(orderFlaw(keys, Uint32Array.of(1, 3, 0, 0))).not.toBeNull();
    expect(orderFlaw(keys, Uint32Array.of(1, 3, 2, 0))).not.toBeNull();
  });
});
