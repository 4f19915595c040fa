import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CullParameters } from '../../data/layout/structs.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { compactChunks as compactReference, prefixScan } from './cull.reference.ts';
import { compactChunks } from './cull.ts';

const gpu = testGpu();

describe('compact-chunks', () => {
  gpuTest('lists the visible chunks in storage order', async () => {
    for (const chunkCount of [1, 63, 64, 65, 1000]) {
      for (const visiblePart of [0, 0.3, 1]) {
        const random = seededRandom(chunkCount);
        const flags = Array.from({ length: chunkCount }, () => (random() < visiblePart ? 1 : 0));
        const dispatchRow = 7;
        const parameters = CullParameters.pack({ chunkCount, pageCount: 1, visibleCapacity: 0, dispatchRow });
        const visibleChunks = gpu.storage(new Uint32Array(chunkCount).fill(0xffffffff));
        await gpu.run(
          compactChunks,
          {
            cullParameters: gpu.uniform(parameters),
            chunkOffsets: gpu.storage(prefixScan(flags)),
            visibleChunks,
          },
          dispatchSize(Math.ceil(chunkCount / 64), dispatchRow),
        );
        const expected = new Uint32Array(chunkCount).fill(0xffffffff);
        expected.set(compactReference(flags));
        expect(await gpu.read(visibleChunks)).toEqual(expected);
      }
    }
  });
});
