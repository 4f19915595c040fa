// Proves: every pixel of tiles with long lists as the reference's, wherever these end.
import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import type { DrawnSplat } from '../../testing/ranked-records.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { always, checkTiles, drawTiles, splats, veil } from '../../testing/tile-pixels.ts';

const gpu = testGpu();

/** Small, as every pixel takes the reference as long as its tile's list. */
const LONG_SIZE = { widthPx: 17, heightPx: 2 };

describe('tile-rest', () => {
  gpuTest('long lists, with room for the fronts of all, some or none of the tiles', async () => {
    // Sparse, dense at first only, or dense: none ends.
    const scene = {
      ranked: splats(14_000, LONG_SIZE, 0.002),
      size: LONG_SIZE,
      isListed: always,
      isMasked: (pair: number, tile: number) => [pair % 3 === 0, pair % 9000 < 3000, true][tile % 3],
    };
    const { longTileCount, ended, data } = await checkTiles(gpu, scene);
    expect(longTileCount).toBe(3);
    expect(ended).toBe(0);
    for (const fronts of [0, 1]) {
      const drawn = await drawTiles(gpu, scene, { isNarrow: false, fronts });
      expect(drawn.data).toEqual(data);
    }
  });

  gpuTest('long lists whose pixels end in their front, behind it, and late', async () => {
    const faint = splats(11_000, LONG_SIZE, 0.002);
    const pixels = LONG_SIZE.widthPx * LONG_SIZE.heightPx;
    const endedWith = async (rank: number, walls: readonly DrawnSplat[]) => {
      const ranked = faint.toSpliced(rank, walls.length, ...walls);
      return (await checkTiles(gpu, { ranked, size: LONG_SIZE, isListed: always, isMasked: always })).ended;
    };
    for (const rank of [500, 3000, 10_000])
      expect(await endedWith(rank, Array(4).fill(veil(1)))).toBe(pixels);
    // Ends only by all teams of threads together.
    const spread = Array.from({ length: 7000 }, (_, i) => veil(i % 1000 === 500 ? 0.9 : 0.001));
    expect(await endedWith(3000, spread)).toBe(pixels);
    expect(await endedWith(3000, [veil(0.5)])).toBe(0);
  });
});
