// Proves: any keys in a stable order, by every shape of the sort.
import { createNodeGpu } from '@websplatter/node';
import { createTestDevice, gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import fc from 'fast-check';
import { describe, expect } from 'vitest';
import { GpuMemory } from '../../gpu/gpu-memory.ts';
import { recordDispatches } from '../../gpu/passes.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { orderFlaw } from '../../inspect/compare-order.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { byBallots, createSortDevice, sortLimitsOf } from '../../testing/sort-device.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { RadixSort, radixSortStages } from './radix-sort.ts';
import { radixSort, sortHistogram } from './sort.reference.ts';
import {
  BALLOT_BLOCKS,
  blockKeysOf,
  DEFAULT_WORKGROUP_BYTES,
  pairSortShapeFor,
  type SortShape,
  sortPlanOf,
  sortShapeFor,
  workgroupBytesOf,
} from './sort.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';
/** Many blocks of any shape. */
const MANY_KEYS = isFull ? 100_000 : 30_000;

const gpu = testGpu(createSortDevice);

/** Number of workgroups that every device takes in one dimension of a dispatch. */
const MAX_ROW = 65_535;

/** Numbers of bits in which keys of frames may differ, one for each shape. */
const KEY_BITS = [8, 16, 20, 24, 27, 32, 64];

/** In the first tier, one for each number of passes and of bits of a digit. */
const PAIR_KEY_BITS = isFull ? [0, 5, 8, 9, 10, 16, 17, 18] : [5, 9, 16, 18];

/** Sorts in a buffer with room for `capacity` keys, with garbage after the given ones. */
async function sortOnGpu(
  keys: Uint32Array,
  shape: SortShape,
  capacity = keys.length,
  dispatchRow = MAX_ROW,
  upperKeys?: Uint32Array,
) {
  await gpu.pipelines.prepare(radixSortStages(shape));
  const memory = new GpuMemory(gpu.device);
  const plan = memory.createFilledBuffer('plan', sortPlanOf(keys.length, shape));
  const sort = new RadixSort(gpu.device, gpu.pipelines, memory, { shape, plan, capacity, dispatchRow });
  const filled = new Uint32Array(capacity).fill(0x12345678);
  filled.set(keys);
  gpu.device.queue.writeBuffer(sort.keys, 0, filled);
  if (upperKeys) gpu.device.queue.writeBuffer(sort.upperKeys!, 0, Uint32Array.from(upperKeys));
  const encoder = gpu.device.createCommandEncoder();
  const pass = encoder.beginComputePass();
  recordDispatches(pass, sort.dispatches);
  pass.end();
  gpu.device.queue.submit([encoder.finish()]);
  const order = (await gpu.read(sort.order)).subarray(0, keys.length);
  memory.destroyAll();
  return order;
}

/** How `sortPairs` sorts, other than by default. */
interface PairOptions {
  /** Whether the number of blocks is read on the GPU; default false. */
  readonly isCounted?: boolean;
  readonly firstCounts?: 'counted' | 'given';
  readonly dispatchRow?: number;
  /** Number of pairs that there is room for beyond the given ones. */
  readonly room?: number;
}

/** Sorts payloads by keys; returns both. */
async function sortPairs(
  keys: Uint32Array,
  payloads: Uint32Array,
  shape: SortShape,
  { isCounted = false, firstCounts = 'counted', dispatchRow = MAX_ROW, room = 0 }: PairOptions = {},
) {
  await gpu.pipelines.prepare(radixSortStages(shape, { firstCounts }));
  const memory = new GpuMemory(gpu.device);
  const blockKeys = blockKeysOf(shape);
  const blockCount = Math.ceil(keys.length / blockKeys);
  const given = {
    plan: gpu.storage([...sortPlanOf(keys.length, shape)]),
    dispatch: gpu.storage([99, ...dispatchSize(blockCount, dispatchRow)], 0, GPUBufferUsage.INDIRECT),
  };
  const sort = new RadixSort(gpu.device, gpu.pipelines, memory, {
    shape,
    plan: given.plan,
    ...(isCounted && { blockDispatch: { buffer: given.dispatch, offset: 4 } }),
    capacity: keys.length + room,
    dispatchRow,
    payloads: 'given',
    writesKeys: true,
    firstCounts,
  });
  gpu.device.queue.writeBuffer(sort.keys, 0, Uint32Array.from(keys));
  gpu.device.queue.writeBuffer(sort.payloads, 0, Uint32Array.from(payloads));
  if (firstCounts === 'given') {
    const counts = sortHistogram(keys, { digitShift: 0, digitBits: shape.digitBits, blockKeys });
    gpu.device.queue.writeBuffer(sort.digitCounts, 0, Uint32Array.from(counts));
  }
  const encoder = gpu.device.createCommandEncoder();
  const pass = encoder.beginComputePass();
  recordDispatches(pass, sort.dispatches);
  pass.end();
  gpu.device.queue.submit([encoder.finish()]);
  const sorted = {
    keys: (await gpu.read(sort.sortedKeys!)).subarray(0, keys.length),
    payloads: (await gpu.read(sort.order)).subarray(0, keys.length),
  };
  memory.destroyAll();
  for (const buffer of Object.values(given)) buffer.destroy();
  return sorted;
}

/** Shapes for little and much workgroup memory, as far as the device has it, by ballots and narrow. */
function shapesFor(bits: number, shapeFor = sortShapeFor): SortShape[] {
  const shapes = sortLimitsOf(gpu.device).map((workgroupBytes) => shapeFor(bits, { workgroupBytes }));
  const distinct = shapes.filter((shape, i) => i === 0 || blockKeysOf(shape) !== blockKeysOf(shapes[i - 1]));
  return [...distinct, ...byBallots(shapes[0], gpu.device), shapeFor(bits, { isNarrow: true })];
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

describe('radix sort', { tags: 'deeper' }, () => {
  // In the first tier, the tests of `project` sort and compare keys of 8 bits, in one pass.
  for (const bits of isFull ? KEY_BITS.filter((each) => each <= 32) : [27, 32]) {
    const { passes, digitBits } = sortShapeFor(bits);
    const name = `${bits} bits, ${passes} passes of ${digitBits}`;

    gpuTest(`${name}: any number of random keys`, async () => {
      for (const shape of shapesFor(bits)) {
        const blockKeys = blockKeysOf(shape);
        for (const count of [0, 1, 2, 255, 256, 257, blockKeys - 1, blockKeys, blockKeys + 1, MANY_KEYS]) {
          const keys = keysOf('random', count, bits);
          const order = await sortOnGpu(keys, shape);
          expect(orderFlaw(keys, order), `${count} keys in blocks of ${blockKeys}`).toBeNull();
          if (count <= blockKeys + 1) expect(order).toEqual(radixSort(keys, { ...shape, blockKeys }));
        }
      }
    });

    gpuTest(`${name}: every pattern`, async () => {
      for (const shape of shapesFor(bits)) {
        const blockKeys = blockKeysOf(shape);
        for (const pattern of Object.keys(PATTERNS)) {
          const keys = keysOf(pattern, 2 * blockKeys + 333, bits);
          const flaw = orderFlaw(keys, await sortOnGpu(keys, shape));
          expect(flaw, `${pattern} in blocks of ${blockKeys}`).toBeNull();
        }
      }
    });

    gpuTest(`${name}: a stable permutation for any keys`, async () => {
      const key = fc.oneof(
        fc.nat({ max: 3 }),
        fc.integer({ min: 0, max: 2 ** bits - 1 }),
        fc.nat({ max: 255 }).map((digit) => digit * 2 ** (bits - 8)),
      );
      for (const shape of shapesFor(bits)) {
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
          { numRuns: isFull ? 8 : 4, seed: 5 },
        );
      }
    });

    gpuTest(`${name}: rows of 7 workgroups, and room for more keys`, async () => {
      for (const shape of shapesFor(bits)) {
        const blockKeys = blockKeysOf(shape);
        const keys = keysOf('random', 9 * blockKeys + 1, bits);
        expect(orderFlaw(keys, await sortOnGpu(keys, shape, 12 * blockKeys, 7))).toBeNull();
      }
    });
  }

  for (const bits of isFull ? [56, 64] : [64]) {
    gpuTest(`${bits} bits: by both words, equal keys in given order`, async () => {
      for (const shape of shapesFor(bits)) {
        const blockKeys = blockKeysOf(shape);
        const random = seededRandom(bits);
        for (const [count, row] of [
          [1, MAX_ROW],
          [blockKeys + 1, MAX_ROW],
          [9 * blockKeys + 1, 7],
        ]) {
          // Few upper words, fewer lower ones in places: either alone leaves the order open.
          const upper = Uint32Array.from(
            { length: count },
            () => Math.floor(40 * random()) * 2 ** (bits - 40),
          );
          const lower = Uint32Array.from({ length: count }, (_, i) => random() * (i % 2 ? 4 : 2 ** 32));
          const order = await sortOnGpu(lower, shape, count + 17, row, upper);
          const expected = radixSort(lower, { ...shape, blockKeys }, upper);
          // Vitest runs out of memory where it shows two long lists that differ.
          const place = order.findIndex((index, i) => index !== expected[i]);
          expect(place, `${count} keys in blocks of ${blockKeys}: first place that differs`).toBe(-1);
        }
      }
    });
  }

  gpuTest('every shape compiles on a device with as little workgroup memory as it was made for', async () => {
    for (const workgroupBytes of sortLimitsOf(gpu.device)) {
      // A plain device has the least limit, and perhaps the shaders from tests before.
      const isDefault = workgroupBytes === DEFAULT_WORKGROUP_BYTES;
      const requiredLimits = { maxComputeWorkgroupStorageSize: workgroupBytes };
      const small = await shareTestDevice(isDefault ? {} : { requiredLimits });
      expect(small.limits.maxComputeWorkgroupStorageSize).toBe(workgroupBytes);
      for (const shape of [
        ...KEY_BITS.map((bits) => sortShapeFor(bits, { workgroupBytes })),
        ...PAIR_KEY_BITS.map((bits) => pairSortShapeFor(bits, { workgroupBytes })),
        ...KEY_BITS.map((bits) => sortShapeFor(bits, { workgroupBytes, isNarrow: true })),
      ])
        await new Pipelines(small).prepare(radixSortStages(shape));
      small.destroy();
    }
    expect(() => sortShapeFor(24, { workgroupBytes: 8000 })).toThrow('8 bits need 14128 bytes');
  });

  gpuTest('ballots take the first block that the device allows, and masks where it allows none', () => {
    const ballots = { min: 32, max: 64, workgroupThreads: 1024 };
    const shapeOf = (bits: number, workgroupBytes: number, workgroupThreads = 1024) =>
      sortShapeFor(bits, { workgroupBytes, ballots: { ...ballots, workgroupThreads } });
    const [[workgroup, itemsPerThread]] = BALLOT_BLOCKS;
    for (const bits of [27, 32]) {
      const subgroups = { min: 32, max: 64 };
      expect(shapeOf(bits, 49_152)).toMatchObject({ workgroup, itemsPerThread, subgroups });
      expect(blockKeysOf(shapeOf(bits, 32_768))).toBeGreaterThanOrEqual(4096);
      expect(shapeOf(bits, 32_768, 256)).toMatchObject({ workgroup: 256, subgroups });
      for (const bytes of [16_384, 32_768]) {
        const shape = shapeOf(bits, bytes);
        expect(shape.subgroups).toEqual(subgroups);
        expect(workgroupBytesOf(shape)).toBeLessThanOrEqual(bytes);
      }
    }
    expect(shapeOf(32, 16_384, 128).subgroups).toBeNull();
    const few = { workgroupBytes: 32_768, ballots: { ...ballots, min: 4 } };
    expect(sortShapeFor(32, few).subgroups).toBeNull();
  });

  for (const bits of PAIR_KEY_BITS) {
    gpuTest(`pairs with keys of ${bits} bits: keys and given payloads in order`, async () => {
      for (const shape of shapesFor(bits, pairSortShapeFor)) {
        expect(shape.passes).toBe(bits <= 9 ? 1 : 2);
        const blockKeys = blockKeysOf(shape);
        for (const count of [0, 1, blockKeys, 3 * blockKeys + 77]) {
          const keys = keysOf('random', count, bits);
          const payloads = keys.map((_, i) => i * 2654435761);
          const sorted = await sortPairs(keys, payloads, shape);
          const order = radixSort(keys, { ...shape, blockKeys });
          expect(sorted.payloads).toEqual(payloads.map((_, i) => payloads[order[i]]));
          expect(sorted.keys).toEqual(keys.map((_, i) => keys[order[i]]));
        }
      }
    });
  }

  gpuTest('the caller may write the first counts and the dispatch', async () => {
    // Of one pass and of two; in the short run, of two.
    for (const bits of isFull ? [7, 14] : [14]) {
      const shape = pairSortShapeFor(bits);
      const keys = keysOf('random', 5 * blockKeysOf(shape) + 3, bits);
      const payloads = keys.map((_, i) => 3 * i);
      const expected = await sortPairs(keys, payloads, shape);
      for (const isCounted of [false, true]) {
        for (const firstCounts of ['given', 'counted'] as const) {
          const options = { isCounted, firstCounts, dispatchRow: 4, room: 7 * blockKeysOf(shape) };
          expect(await sortPairs(keys, payloads, shape, options)).toEqual(expected);
          const none = await sortPairs(new Uint32Array(), new Uint32Array(), shape, options);
          expect(none.keys.length).toBe(0);
        }
      }
    }
  });

  gpuTest('a million keys (full mode)', async ({ skip }) => {
    if (!isFull) skip('set WEBSPLATTER_FULL=1');
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

  gpuTest(
    'more blocks than one dimension of a dispatch takes, at true size (full mode)',
    async ({ skip }) => {
      const { adapter, isSoftware } = await createNodeGpu();
      if (!isFull) skip('set WEBSPLATTER_FULL=1');
      if (isSoftware) skip('needs a GPU: minutes and gigabytes in software');
      const shape = sortShapeFor(32);
      const count = (MAX_ROW + 1) * shape.workgroup * shape.itemsPerThread + 1;
      const { maxBufferSize, maxStorageBufferBindingSize } = adapter.limits;
      if (maxStorageBufferBindingSize < 4 * count) skip(`needs bindings of ${4 * count} bytes`);
      gpu.device = await createTestDevice({ requiredLimits: { maxBufferSize, maxStorageBufferBindingSize } });
      gpu.pipelines = new Pipelines(gpu.device);
      const keys = keysOf('random', count, 32);
      expect(orderFlaw(keys, await sortOnGpu(keys, shape))).toBeNull();
    },
  );
});
