import { createTestDevice, gpuTest } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { Pipelines } from '../gpu/pipelines.ts';
import { readWords } from '../gpu/read-buffer.ts';
import { SortParameters } from '../layout/structs.ts';
import { prefixScan } from '../reference/prefix-scan.ts';
import { sortHistogram as histogramTwin } from '../reference/sort-histogram.ts';
import { sortScatter as scatterTwin } from '../reference/sort-scatter.ts';
import { runStage, storageBuffer, uniformBuffer } from '../testing/gpu-buffers.ts';
import { seededRandom } from '../testing/seeded-random.ts';
import { dispatchSize } from './dispatch.ts';
import { sortScatter } from './sort-scatter.ts';
import { sortShapeFor } from './sort-shape.ts';

let device: GPUDevice;
let pipelines: Pipelines;
beforeAll(async () => {
  device = await createTestDevice();
  pipelines = new Pipelines(device);
});
afterAll(() => device.destroy());

describe('sort-scatter', () => {
  for (const [bits, isFirst, isLast] of [
    [24, true, false],
    [24, false, false],
    [24, false, true],
    [16, true, true],
    [27, false, false],
  ] as const) {
    const name = `${isFirst ? 'first' : 'later'} pass, ${isLast ? 'last' : 'not last'}, of ${bits} bits`;
    gpuTest(`${name}: moves keys and payloads to the twin's places`, async () => {
      const random = seededRandom(4);
      const shape = sortShapeFor(bits);
      const tileKeys = shape.workgroup * shape.itemsPerThread;
      const dispatchRow = 2;
      const count = 3 * tileKeys + 1234;
      const pass = { digitShift: shape.digitBits, digitBits: shape.digitBits, tileKeys };
      // Few digits in the first half, so that ranks within a round are large; all digits in the second.
      const keys = Uint32Array.from(
        { length: count },
        (_, i) => random() * (i < count / 2 ? 2 ** (shape.digitBits + 2) : 2 ** bits),
      );
      const payloads = Uint32Array.from(keys, () => Math.floor(random() * 2 ** 32));
      const tileCount = Math.ceil(count / tileKeys);
      const digitOffsets = prefixScan(histogramTwin(keys, pass));
      const radix = 1 << shape.digitBits;
      const parameters = SortParameters.pack({
        digitShift: pass.digitShift,
        radix,
        capacity: count,
        dispatchRow,
        isFirst: Number(isFirst),
        isLast: Number(isLast),
      });
      const keysOut = storageBuffer(device, [], 4 * count);
      const payloadsOut = storageBuffer(device, [], 4 * count);
      const bindings = {
        parameters: uniformBuffer(device, parameters),
        plan: storageBuffer(device, [count, tileCount]),
        digitOffsets: storageBuffer(device, digitOffsets),
        keysIn: storageBuffer(device, keys),
        payloadsIn: storageBuffer(device, payloads),
        payloadsOut,
        keysOut,
      };
      await runStage(device, pipelines, sortScatter(shape), bindings, dispatchSize(tileCount, dispatchRow));
      const taken = isFirst ? keys.map((_, i) => i) : payloads;
      const expected = scatterTwin(keys, taken, digitOffsets, pass);
      expect(await readWords(device, payloadsOut)).toEqual(expected.payloads);
      expect(await readWords(device, keysOut)).toEqual(isLast ? new Uint32Array(count) : expected.keys);
    });
  }
});
