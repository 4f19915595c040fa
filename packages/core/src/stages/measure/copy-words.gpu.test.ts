import { gpuTest } from '@websplatter/node/gpu-test';
import { expect } from 'vitest';
import { testGpu } from '../../testing/test-gpu.ts';
import { copyWords as reference } from './measure.reference.ts';
import { COPY_WORKGROUP, copyWords } from './measure.ts';

const gpu = testGpu();

gpuTest('copy-words copies every word and none beyond', async () => {
  for (const count of [4, 4 * COPY_WORKGROUP, 4 * COPY_WORKGROUP + 4, 50_000]) {
    const words = Uint32Array.from({ length: count }, (_, i) => Math.imul(i + 1, 0x9e3779b1));
    const wordsOut = gpu.storage([], 4 * count);
    const bindings = { wordsIn: gpu.storage(words), wordsOut };
    // More workgroups than are needed, in two rows.
    await gpu.run(copyWords, bindings, [Math.ceil(count / 4 / COPY_WORKGROUP), 2, 1]);
    expect(await gpu.read(wordsOut)).toEqual(reference(words));
  }
});
