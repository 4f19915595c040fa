import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { DILATION_PX2 } from '../../data/accuracy/accuracy.ts';
import { projectionOf } from '../../data/camera/camera.ts';
import { cloudView } from '../../data/camera/cloud-view.ts';
import { type FrustumSide, frustumSides } from '../../data/camera/frustum.ts';
import { Chunk } from '../../data/layout/structs.ts';
import { packCloud } from '../../data/packing/packed-cloud.ts';
import { anyCamera, anyModel } from '../../testing/any-view.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { countChunksInFrustum } from './chunk-groups.ts';

/** Chunks of 256 splats that are small beside the cloud, the last one not full. */
const set = randomSplats({ count: 200_000, shDegree: 0, logScales: [-9, -7] });
const { chunks } = packCloud(set, { geometryPrecision: 'packed' });
const chunkCount = chunks.byteLength / Chunk.bytes;

/** Each chunk by itself. */
function countOneByOne(sides: readonly FrustumSide[]): number {
  let count = 0;
  for (let i = 0; i < chunkCount; i++)
    count += countChunksInFrustum(chunks.slice(i * Chunk.bytes, (i + 1) * Chunk.bytes), sides);
  return count;
}

describe('countChunksInFrustum', () => {
  test('counts as many chunks by groups as one by one', () => {
    const counts = new Set<number>();
    fc.assert(
      fc.property(anyCamera, anyModel, (camera, modelMatrix) => {
        const projection = projectionOf(camera, 64, 48);
        const view = cloudView(camera.viewMatrix, modelMatrix, set.origin, projection.isOrthographic);
        const sides = frustumSides(view, projection, 1 / 255, DILATION_PX2);
        const count = countChunksInFrustum(chunks, sides);
        counts.add(count);
        expect(count).toBe(countOneByOne(sides));
      }),
      { numRuns: 100, seed: 1 },
    );
    // All, none, and many between.
    expect(counts.size).toBeGreaterThan(20);
  });

  test('counts chunks that only reach into the frustum, and none in an empty cloud', () => {
    const side = (offset: number, reach: number): FrustumSide => ({ normal: [1, 0, 0], offset, reach });
    // All splats lie within 1 of the origin.
    expect(countChunksInFrustum(chunks, [side(2, 0)])).toBe(chunkCount);
    expect(countChunksInFrustum(chunks, [side(-2, 0)])).toBe(0);
    expect(countChunksInFrustum(chunks, [side(-2, 1e6)])).toBe(chunkCount);
    expect(countChunksInFrustum(new ArrayBuffer(0), [side(2, 0)])).toBe(0);
  });
});
