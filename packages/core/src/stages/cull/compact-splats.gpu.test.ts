import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CullParameters } from '../../data/layout/structs.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { compactSplats as compactReference, prefixScan } from './cull.reference.ts';
import { compactSplats } from './cull.ts';

const gpu = testGpu();

describe('compact-splats', () => {
  gpuTest('lists the visible splats in storage order, as many as there is room for', async () => {
    for (const [slots, chunkCount, room] of [
      [0, 3, 0],
      [1, 1, 256],
      [1, 9, 2304],
      [40, 100, 25_600],
      // Some splats, and whole slots, find no room.
      [40, 100, 3000],
    ]) {
      const random = seededRandom(slots);
      const visibleChunks = Array.from({ length: slots }, (_, slot) => 2 * slot + (slots === 40 ? 1 : 0));
      // Empty words, full words and everything in between.
      const masks = Uint32Array.from({ length: 8 * chunkCount }, (_, i) =>
        i >= 8 * slots ? 0xffffffff : [0, 0xffffffff, random() * 2 ** 32][i % 3],
      );
      const expected = compactReference(visibleChunks, masks, room);
      const counts = visibleChunks.map(
        (_, slot) => compactReference([0], masks.subarray(8 * slot, 8 * slot + 8), 256).length,
      );
      const parameters = CullParameters.pack({
        chunkCount,
        pageCount: 1,
        visibleCapacity: room,
        dispatchRow: 7,
      });
      const visibleSplats = gpu.storage(new Uint32Array(256 * chunkCount).fill(0xffffffff));
      await gpu.run(
        compactSplats,
        {
          cullParameters: gpu.uniform(parameters),
          slotCount: gpu.storage([slots]),
          visibleChunks: gpu.storage(visibleChunks, 4 * chunkCount),
          visibilityMasks: gpu.storage(masks),
          splatOffsets: gpu.storage(prefixScan(counts), 4 * (chunkCount + 1)),
          visibleSplats,
        },
        // An extra workgroup must do nothing.
        dispatchSize(slots + 1, 7),
      );
      const words = await gpu.read(visibleSplats);
      expect(words.subarray(0, expected.length)).toEqual(Uint32Array.from(expected));
      expect(words.subarray(expected.length).every((word) => word === 0xffffffff)).toBe(true);
    }
  });
});
