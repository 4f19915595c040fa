import { gpuTest } from '@websplatter/node/gpu-test';
import { expect } from 'vitest';
import { PermuteParameters } from '../../data/layout/packing-structs.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { ingestScatter as reference } from './ingest.reference.ts';
import { ingestScatter } from './ingest.ts';

const SPLATS = 600;
const WIDTH = 3;
const DISPATCH_ROW = 2;
/** Splats of the cloud before those of the page. */
const PAGE_START = 256;

const gpu = testGpu();

for (const [word, count] of [
  [1, 1],
  [1, 2],
]) {
  gpuTest(`ingest-scatter writes ${count} words of all splats of a page, and nothing else`, async () => {
    const before = Uint32Array.from({ length: SPLATS * WIDTH }, (_, i) => Math.imul(i, 0x9e3779b1));
    const words = Uint32Array.from({ length: count * (PAGE_START + SPLATS) }, (_, i) =>
      Math.imul(i, 0x85ebca6b),
    );
    const contents = PermuteParameters.pack({
      word,
      words: count,
      wordsPerSplat: WIDTH,
      mask: 0,
      pageStart: PAGE_START,
      pageEnd: PAGE_START + SPLATS,
      count: words.length,
      dispatchRow: DISPATCH_ROW,
    });
    const plane = gpu.storage(before);
    const bindings = {
      parameters: gpu.uniform(contents),
      words: gpu.storage(words),
      plane,
    };
    const size = dispatchSize(Math.ceil(SPLATS / 256), DISPATCH_ROW);
    await gpu.run(ingestScatter, bindings, size);
    expect(await gpu.read(plane)).toEqual(
      reference(before, WIDTH, word, count, words.subarray(count * PAGE_START)),
    );
  });
}
