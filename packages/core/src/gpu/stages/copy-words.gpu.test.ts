import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { expect } from 'vitest';
import { copyWords as reference } from '../../reference/copy-words.ts';
import { runStage, storageBuffer } from '../../testing/gpu-buffers.ts';
import { Pipelines } from '../pipelines.ts';
import { readWords } from '../read-buffer.ts';
import { COPY_WORKGROUP, copyWords } from './copy-words.ts';

gpuTest('copy-words copies every word and none beyond', async () => {
  const device = await shareTestDevice();
  const pipelines = new Pipelines(device);
  for (const count of [4, 4 * COPY_WORKGROUP, 4 * COPY_WORKGROUP + 4, 50_000]) {
    const words = Uint32Array.from({ length: count }, (_, i) => Math.imul(i + 1, 0x9e3779b1));
    const wordsOut = storageBuffer(device, [], 4 * count);
    const bindings = { wordsIn: storageBuffer(device, words), wordsOut };
    // More workgroups than are needed, in two rows.
    await runStage(device, pipelines, copyWords, bindings, [Math.ceil(count / 4 / COPY_WORKGROUP), 2, 1]);
    expect(await readWords(device, wordsOut)).toEqual(reference(words));
  }
  device.destroy();
});
