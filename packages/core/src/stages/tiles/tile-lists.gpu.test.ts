import { gpuTest } from '@websplatter/node/gpu-test';
import fc from 'fast-check';
import { describe, expect } from 'vitest';
import type { RecordPrecision } from '../../data/accuracy/accuracy.ts';
import { binGrid } from '../../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { SortPlan, TilePlan } from '../../data/layout/structs.ts';
import { type DrawnSplat, rankedBuffers, rankedRecords } from '../../testing/ranked-records.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { merged, tilesOfPair, tileUniforms } from '../../testing/tile-buffers.ts';
import { uniform } from '../../testing/uniform.ts';
import { dispatchSize } from '../dispatch.ts';
import { blockKeysOf, pairSortShapeFor } from '../sort/sort.ts';
import { alphaAt, largerBins } from './tiles.reference.ts';
import { tileCount, tileEmit, tileMasks, tilePlan } from './tiles.ts';

const { BIN_TILES, MASK_GROUP, TILE_PX } = SHADER_CONSTANTS;
const MASK_WORDS = (BIN_TILES * BIN_TILES) / 32;
/** 3×2 bins, 17×9 tiles. */
const SIZE = { widthPx: 131, heightPx: 70 };
const GRID = binGrid(SIZE.widthPx, SIZE.heightPx);
const BINS = GRID.binColumns * GRID.binRows;
const TILE_COLUMNS = Math.ceil(SIZE.widthPx / TILE_PX);
const TILE_ROWS = Math.ceil(SIZE.heightPx / TILE_PX);
/** Splats per run. */
const BATCH = 64;
const isFull = process.env.WEBSPLATTER_FULL === '1';
const RUNS = isFull ? 100 : 25;
/** Rounding may decide about opacities nearer to the cutoff. */
const MARGIN = 1e-4;

const gpu = testGpu();

/** Tiles, counted through the layer, that the GPU lists for each of the splats. */
async function listedTiles(
  packed: ReturnType<typeof rankedRecords>,
  options: ListOptions,
): Promise<Set<number>[]> {
  const { recordPrecision, alphaCutoff } = options;
  const count = packed.records.length;
  const shape = pairSortShapeFor(Math.ceil(Math.log2(BINS + 1)));
  const mostPairs = count * BINS;
  const blockPairs = gpu.storage([0]);
  const plan = gpu.storage([], TilePlan.bytes);
  const blocks = Math.ceil(mostPairs / blockKeysOf(shape));
  const pairBins = gpu.storage([], 4 * mostPairs);
  const pairRecords = gpu.storage([], 4 * mostPairs);
  const groups = Math.ceil(mostPairs / MASK_GROUP);
  const masks = gpu.storage([], 4 * groups * MASK_GROUP * MASK_WORDS);
  const all = {
    ...tileUniforms(gpu, { size: SIZE, alphaCutoff, pairCapacity: options.room * count }),
    ...rankedBuffers(gpu, packed),
    pairOffsets: gpu.storage([], 4 * count),
    blockPairs,
    tilePlan: plan,
    sortPlan: gpu.storage([], SortPlan.bytes),
    drawArguments: gpu.storage([], 16),
    pairDispatches: gpu.storage([], 24),
    pairBins,
    pairRecords,
    digitCounts: gpu.storage([], 4 * (blocks << shape.digitBits)),
    // Masks are made pair by pair: whether pairs are sorted makes no difference.
    sortedBins: pairBins,
    sortedRecords: pairRecords,
    tileMasks: masks,
  };
  const variant = { recordPrecision, extent: 'opacity', isStacked: options.isStacked } as const;
  await gpu.run(tileCount(variant), all, [1, 1, 1]);
  await gpu.run(tilePlan(shape), all, [1, 1, 1]);
  await gpu.run(tileCount(variant, true), all, [1, 1, 1]);
  await gpu.run(tilePlan(shape, true), all, [1, 1, 1]);
  await gpu.run(tileEmit(variant, shape), all, dispatchSize(blocks, 65_535));
  await gpu.run(tileMasks(variant), all, dispatchSize(groups, 65_535));
  const [words, bins, places] = await Promise.all(
    [masks, pairBins, pairRecords].map((buffer) => gpu.read(buffer)),
  );
  const [, pairCount, , , binShift] = await gpu.read(plan);
  const { binColumns } = largerBins(GRID, binShift);
  const blockTiles = 2 ** binShift;
  for (const buffer of Object.values(all)) buffer.destroy();
  const tiles = packed.records.map(() => new Set<number>());
  const rankOf = new Map(Array.from(packed.places, (place, rank) => [place, rank]));
  for (let pair = 0; pair < pairCount; pair++) {
    const [column, row] = [bins[pair] % binColumns, Math.floor(bins[pair] / binColumns)];
    for (const tile of tilesOfPair(words, pair)) {
      const left = (column * BIN_TILES + (tile % BIN_TILES)) * blockTiles;
      const top = (row * BIN_TILES + Math.floor(tile / BIN_TILES)) * blockTiles;
      for (let y = top; y < Math.min(top + blockTiles, TILE_ROWS); y++)
        for (let x = left; x < Math.min(left + blockTiles, TILE_COLUMNS); x++)
          tiles[rankOf.get(places[pair])!].add(y * TILE_COLUMNS + x);
    }
  }
  return tiles;
}

interface ListOptions {
  readonly recordPrecision: RecordPrecision;
  readonly alphaCutoff: number;
  readonly isStacked?: boolean;
  /** Pairs that there is room for, per splat. */
  readonly room: number;
}

/** A pixel where the record is clearly drawn, in a tile that `isLeftOut`; null if there is none. */
function drawnPixel(
  record: Parameters<typeof alphaAt>[0],
  alphaCutoff: number,
  isLeftOut: (tile: number) => boolean,
) {
  for (let tile = 0; tile < TILE_COLUMNS * TILE_ROWS; tile++) {
    if (!isLeftOut(tile)) continue;
    const [left, top] = [TILE_PX * (tile % TILE_COLUMNS), TILE_PX * Math.floor(tile / TILE_COLUMNS)];
    for (let y = top; y < Math.min(top + TILE_PX, SIZE.heightPx); y++)
      for (let x = left; x < Math.min(left + TILE_PX, SIZE.widthPx); x++)
        if (alphaAt(record, x, y) >= alphaCutoff * (1 + MARGIN)) return { x, y };
  }
  return null;
}

/** Any angle, and those at which a coordinate of an axis is 0 or nearly so. */
const angle = fc.oneof(
  { weight: 3, arbitrary: uniform(0, Math.PI) },
  { weight: 1, arbitrary: fc.constantFrom(0, Math.PI / 2, Math.PI / 4, 1e-3, 1e-6, Math.PI / 2 + 1e-4) },
);
const opacity = fc.oneof(uniform(0, 1), fc.constantFrom(1, 1 / 255, 0.004, 0.02));

/** Points, circles and ellipses in and around the layer. */
const nearSplat: fc.Arbitrary<DrawnSplat> = fc
  .record({
    centerPx: fc.tuple(uniform(-60, 190), uniform(-60, 130)),
    minorLengthPx: uniform(-2, 7).map((exponent) => 2 ** exponent),
    slimness: fc.oneof(uniform(0, 8), fc.constant(0)).map((exponent) => 2 ** exponent),
    angle,
    opacity,
  })
  .map(({ slimness, ...splat }) => ({ ...splat, majorLengthPx: splat.minorLengthPx * slimness }));

/** Needles up to 10⁶ px long through a point of the layer, with centres twice as far out. */
const needle: fc.Arbitrary<DrawnSplat> = fc
  .record({
    through: fc.tuple(uniform(-5, 136), uniform(-5, 75)),
    along: uniform(-2.3, 2.3),
    majorLengthPx: uniform(5, 20).map((exponent) => 2 ** exponent),
    minorLengthPx: uniform(-1, 5).map((exponent) => 2 ** exponent),
    angle,
    opacity,
  })
  .map(({ through: [x, y], along, ...splat }) => {
    const distancePx = along * splat.majorLengthPx;
    const centerPx = [
      x - distancePx * Math.cos(splat.angle),
      y - distancePx * Math.sin(splat.angle),
    ] as const;
    return { ...splat, centerPx };
  });

describe('tile-count, tile-plan, tile-emit and tile-masks', () => {
  gpuTest(
    'leave out no bin and no tile with a pixel where a splat is drawn',
    { tags: 'deeper' },
    async () => {
      const batch = fc.array(fc.oneof(nearSplat, needle), { minLength: BATCH, maxLength: BATCH });
      const settings = fc.record({
        recordPrecision: fc.constantFrom<RecordPrecision[]>('f32', 'f16', 'paper'),
        alphaCutoff: fc.constantFrom(1 / 255, 0.02, 1e-4),
        isStacked: fc.boolean(),
        // At last, all of them; before, larger bins are needed.
        room: fc.constantFrom(1, 2, BINS),
      });
      let [drawn, listed, leftOut] = [0, 0, 0];
      await fc.assert(
        fc.asyncProperty(batch, settings, async (ranked, options) => {
          const splats = options.isStacked ? ranked.map(merged) : ranked;
          const packed = rankedRecords(splats, options.recordPrecision);
          for (const [rank, tiles] of (await listedTiles(packed, options)).entries()) {
            const record = packed.records[rank];
            const missed = drawnPixel(record, options.alphaCutoff, (tile) => !tiles.has(tile));
            if (missed) expect.fail(`${JSON.stringify({ missed, ...options, splat: splats[rank], record })}`);
            if (tiles.size > 0) drawn++;
            listed += tiles.size;
            leftOut += TILE_COLUMNS * TILE_ROWS - tiles.size;
          }
        }),
        // Smaller batches show no more than the message.
        { numRuns: RUNS, seed: 12, endOnFailure: true },
      );
      // Neither nothing nor everything is listed.
      expect(drawn).toBeGreaterThan(isFull ? 2000 : 450);
      expect(listed).toBeGreaterThan(isFull ? 20_000 : 5000);
      expect(leftOut).toBeGreaterThan(isFull ? 200_000 : 50_000);
    },
  );
});
