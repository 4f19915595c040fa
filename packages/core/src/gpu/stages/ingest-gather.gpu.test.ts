import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { expect } from 'vitest';
import { PermuteParameters } from '../../data/layout/packing-structs.ts';
import { ingestGather as reference } from '../../reference/ingest-gather.ts';
import { runStage, storageBuffer, uniformBuffer } from '../../testing/gpu-buffers.ts';
import { Pipelines } from '../pipelines.ts';
import { readWords } from '../read-buffer.ts';
import { dispatchSize } from './dispatch.ts';
import { ingestGather } from './ingest-gather.ts';

const SPLATS = 900;
const WIDTH = 3;
const DISPATCH_ROW = 2;

gpuTest('ingest-gather takes any words of the splats of a list, page by page', async () => {
  const device = await shareTestDevice();
  const pipelines = new Pipelines(device);
  const plane = Uint32Array.from({ length: SPLATS * WIDTH }, (_, i) => Math.imul(i, 0x9e3779b1));
  // A splat may be missing, or there twice.
  const list = Uint32Array.from({ length: 700 }, (_, i) => (i * 257) % SPLATS).fill(5, 690);
  for (const [word, count, mask] of [
    [0, 1, 0xffffffff],
    [2, 1, 0x00ffff],
    [0, 2, 0xffffffff],
    [1, 2, 0x00ffff],
  ]) {
    const words = storageBuffer(device, [], 4 * count * list.length);
    for (const [pageStart, pageEnd] of [
      [0, 512],
      [512, SPLATS],
    ]) {
      const sizes = { word, words: count, wordsPerSplat: WIDTH, mask, pageStart, pageEnd };
      const contents = PermuteParameters.pack({ ...sizes, count: list.length, dispatchRow: DISPATCH_ROW });
      const bindings = {
        parameters: uniformBuffer(device, contents),
        plane: storageBuffer(device, plane.subarray(pageStart * WIDTH, pageEnd * WIDTH)),
        list: storageBuffer(device, list),
        words,
      };
      const size = dispatchSize(Math.ceil(list.length / 256), DISPATCH_ROW);
      await runStage(device, pipelines, ingestGather, bindings, size);
    }
    expect(await readWords(device, words)).toEqual(reference(plane, WIDTH, word, count, list, mask));
  }
  device.destroy();
});
