// Proves: sums over any number of values, beyond what one dispatch takes.
import { gpuTest } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { SCAN_BLOCK } from '../../data/layout/constants.ts';
import { GpuMemory } from '../../gpu/gpu-memory.ts';
import { recordDispatches } from '../../gpu/passes.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { prefixScan } from './cull.reference.ts';
import { PrefixScan, prefixScanStages } from './cull.ts';

const gpu = testGpu();

beforeAll(async () => {
  await gpu.pipelines.prepare([...prefixScanStages(false), ...prefixScanStages(true)]);
});

/**
 * Scans `counts` in a buffer with room for `capacity`, by many threads per block and by few, which
 * give the same; the rest of it is garbage.
 */
async function scanOnGpu(counts: Uint32Array, capacity = counts.length, dispatchRow = 65_535) {
  const [many, few] = [
    await scanBy(false, counts, capacity, dispatchRow),
    await scanBy(true, counts, capacity, dispatchRow),
  ];
  expect(firstMismatch(few, many)).toBeNull();
  return { sums: many.subarray(0, counts.length + 1), behind: many.subarray(counts.length + 1) };
}

async function scanBy(isNarrow: boolean, counts: Uint32Array, capacity: number, dispatchRow: number) {
  const memory = new GpuMemory(gpu.device);
  const filled = new Uint32Array(capacity + 1).fill(0xdeadbeef);
  filled.set(counts);
  const values = gpu.storage(filled);
  const inputCount = gpu.storage([counts.length]);
  const scan = new PrefixScan(gpu.device, gpu.pipelines, memory, {
    label: 'test',
    values,
    inputCount,
    maxCount: capacity,
    dispatchRow,
    isNarrow,
  });
  const encoder = gpu.device.createCommandEncoder();
  const pass = encoder.beginComputePass();
  recordDispatches(pass, scan.dispatches);
  pass.end();
  gpu.device.queue.submit([encoder.finish()]);
  const words = await gpu.read(values);
  memory.destroyAll();
  values.destroy();
  inputCount.destroy();
  return words;
}

function randomCounts(count: number): Uint32Array {
  const random = seededRandom(count);
  return Uint32Array.from({ length: count }, () => Math.floor(300 * random()));
}

const counts = [0, 1, 2, 7, 255, 256, 257, SCAN_BLOCK - 1, SCAN_BLOCK, SCAN_BLOCK + 1, 100_003];
const large = [SCAN_BLOCK ** 2 - 1, SCAN_BLOCK ** 2, SCAN_BLOCK ** 2 + 1];

describe('prefix-scan', () => {
  for (const count of process.env.WEBSPLATTER_FULL ? [...counts, ...large] : counts) {
    gpuTest(`${count} counts give the sums of the reference`, async () => {
      const values = randomCounts(count);
      const { sums } = await scanOnGpu(values);
      expect(firstMismatch(sums, prefixScan(values))).toBeNull();
    });
  }

  gpuTest('fewer counts than there is room for: later words neither count nor change', async () => {
    for (const [count, capacity] of [
      [0, 5000],
      [10, 3 * SCAN_BLOCK],
      [SCAN_BLOCK, 2 * SCAN_BLOCK],
      [SCAN_BLOCK + 1, 9 * SCAN_BLOCK],
    ]) {
      const values = randomCounts(count);
      const { sums, behind } = await scanOnGpu(values, capacity);
      expect(firstMismatch(sums, prefixScan(values))).toBeNull();
      expect(behind.every((word) => word === 0xdeadbeef)).toBe(true);
    }
  });

  gpuTest('rows of 7 workgroups use the second dimension of the dispatch', async () => {
    const values = randomCounts(20 * SCAN_BLOCK + 5);
    const { sums } = await scanOnGpu(values, values.length, 7);
    expect(firstMismatch(sums, prefixScan(values))).toBeNull();
  });

  gpuTest('sums wrap at 2^32 as the reference does', async () => {
    const values = new Uint32Array(3 * SCAN_BLOCK).fill(0x80000001);
    const { sums } = await scanOnGpu(values);
    expect(firstMismatch(sums, prefixScan(values))).toBeNull();
  });
});

function firstMismatch(actual: Uint32Array, expected: Uint32Array) {
  const index = expected.findIndex((value, i) => actual[i] !== value);
  return index < 0 ? null : { index, actual: actual[index], expected: expected[index] };
}
