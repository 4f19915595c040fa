import { gpuTest } from '@websplatter/node/gpu-test';
import { expect } from 'vitest';
import { PermuteParameters } from '../../data/layout/packing-structs.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { ingestGather as reference } from './gather.reference.ts';
import { ingestGather } from './gather.ts';

const SPLATS = 900;
const WIDTH = 3;
const DISPATCH_ROW = 2;

const gpu = testGpu();

gpuTest('ingest-gather takes any words of the splats of a list, page by page', async () => {
  const plane = Uint32Array.from({ length: SPLATS * WIDTH }, (_, i) => Math.imul(i, 0x9e3779b1));
  // A splat may be missing, or there twice.
  const list = Uint32Array.from({ length: 700 }, (_, i) => (i * 257) % SPLATS).fill(5, 690);
  for (const [word, count, mask] of [
    [0, 1, 0xffffffff],
    [2, 1, 0x00ffff],
    [0, 2, 0xffffffff],
    [1, 2, 0x00ffff],
  ]) {
    const words = gpu.storage([], 4 * count * list.length);
    for (const [pageStart, pageEnd] of [
      [0, 512],
      [512, SPLATS],
    ]) {
      const sizes = { word, words: count, wordsPerSplat: WIDTH, mask, pageStart, pageEnd };
      const contents = PermuteParameters.pack({ ...sizes, count: list.length, dispatchRow: DISPATCH_ROW });
      const bindings = {
        parameters: gpu.uniform(contents),
        plane: gpu.storage(plane.subarray(pageStart * WIDTH, pageEnd * WIDTH)),
        list: gpu.storage(list),
        words,
      };
      const size = dispatchSize(Math.ceil(list.length / 256), DISPATCH_ROW);
      await gpu.run(ingestGather, bindings, size);
    }
    expect(await gpu.read(words)).toEqual(reference(plane, WIDTH, word, count, list, mask));
  }
});
