import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import type { RecordPrecision, SizePx } from '../../data/accuracy/accuracy.ts';
import { binGrid } from '../../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { type DrawnSplat, type RankedRecord, rankedRecords } from '../../testing/ranked-records.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { maskPlace, merged, tileUniforms } from '../../testing/tile-buffers.ts';
import { dispatchSize } from '../dispatch.ts';
import { alphaAt, OPAQUE } from '../tiles/tiles.reference.ts';
import { meanLogContribution, pixelCosts } from './tile-costs.reference.ts';
import { CONTRIBUTION_UNITS, tileCosts, UNSEEN_PX } from './tile-costs.ts';

const { BIN_TILES, MASK_GROUP, TILE_PX } = SHADER_CONSTANTS;
const TILES = BIN_TILES * BIN_TILES;
const ALPHA_CUTOFF = 1 / 255;
/** No multiple of a tile's or a bin's size; 2×2 bins. */
const SIZE: SizePx = { widthPx: 75, heightPx: 69 };
const PIXELS = SIZE.widthPx * SIZE.heightPx;
const TILE_COLUMNS = Math.ceil(SIZE.widthPx / TILE_PX);
const TILE_COUNT = TILE_COLUMNS * Math.ceil(SIZE.heightPx / TILE_PX);

const gpu = testGpu();

/**
 * For each bin, the ranks that it lists, front to back; in masks, half of the tiles of each, and
 * bits of no pair.
 */
function pairsOf(count: number) {
  const { binColumns, binRows } = binGrid(SIZE.widthPx, SIZE.heightPx);
  const random = seededRandom(7);
  const ranks: number[] = [];
  const binStarts = [0];
  for (let bin = 0; bin < binColumns * binRows; bin++) {
    for (let rank = 0; rank < count; rank++) if (random() < 0.9) ranks.push(rank);
    binStarts.push(ranks.length);
  }
  const masks = new Uint32Array(Math.ceil(ranks.length / MASK_GROUP) * ((TILES * MASK_GROUP) / 32));
  for (let i = 0; i < masks.length; i++) masks[i] = 2 ** 32 * random();
  /** Places, among all pairs, of those that a tile of a bin lists. */
  const listOf = (bin: number, tile: number) =>
    Array.from({ length: binStarts[bin + 1] - binStarts[bin] }, (_, i) => binStarts[bin] + i).filter(
      (pair) => {
        const [word, bit] = maskPlace(pair, tile);
        return (masks[word] >>> bit) & 1;
      },
    );
  return { ranks, binStarts, masks, binColumns, listOf };
}

/** Runs both passes over `ranked` splats, nearest first; `before` are their first contributions. */
async function run(
  ranked: readonly DrawnSplat[],
  recordPrecision: RecordPrecision,
  { before = 0, isStacked = false } = {},
) {
  const packed = rankedRecords(ranked, recordPrecision);
  const pairs = pairsOf(ranked.length);
  const dispatchRow = 7;
  const contributions = gpu.storage(new Uint32Array(2 * ranked.length).fill(before));
  const pixels = gpu.storage([], 4 * 3 * PIXELS);
  const tileEntries = gpu.storage([], 4 * TILE_COUNT);
  const bindings = {
    ...tileUniforms(gpu, { size: SIZE, alphaCutoff: ALPHA_CUTOFF, dispatchRow }),
    binStarts: gpu.storage(pairs.binStarts),
    tileMasks: gpu.storage(pairs.masks),
    sortedRecords: gpu.storage(pairs.ranks.map((rank) => packed.places[rank])),
    records: gpu.storage(packed.words),
    contributions,
    pixels,
    tileEntries,
  };
  // Workgroups behind the last tile must do nothing.
  const workgroups = dispatchSize(TILE_COUNT + 3, dispatchRow);
  await gpu.run(tileCosts(recordPrecision, 'counts', isStacked), bindings, workgroups);
  const counts = await gpu.read(pixels);
  const entries = await gpu.read(tileEntries);
  const units = await gpu.read(contributions);
  await gpu.run(tileCosts(recordPrecision, 'map', isStacked), bindings, workgroups);
  const map = await gpu.read(pixels);
  const contributionsPx = Array.from(
    packed.places,
    (place) => (units[2 * place] + 2 ** 32 * units[2 * place + 1]) / CONTRIBUTION_UNITS,
  );
  return { records: packed.records, pairs, counts, entries, contributionsPx, map };
}

/** Whether rounding may decide if a record is drawn at a pixel, or if the pixel ends there. */
function isDoubtful(records: readonly RankedRecord[], x: number, y: number): boolean {
  let light = 1;
  return records.some((record) => {
    const alpha = alphaAt(record, x, y);
    if (alpha >= ALPHA_CUTOFF) light *= 1 - alpha;
    return Math.abs(alpha - ALPHA_CUTOFF) < 2e-5 || Math.abs(light / OPAQUE - 1) < 0.02;
  });
}

/** Moderate splats in and around the layer, nearest first, and small ones behind, mostly hidden. */
function splats(count: number): DrawnSplat[] {
  const random = seededRandom(count);
  return Array.from({ length: count }, (_, i) => {
    const minorLengthPx = i < 0.8 * count ? 3 * 8 ** random() : 1;
    return {
      centerPx: [(1.2 * random() - 0.1) * SIZE.widthPx, (1.2 * random() - 0.1) * SIZE.heightPx],
      minorLengthPx,
      majorLengthPx: minorLengthPx * 6 ** random(),
      angle: Math.PI * random(),
      opacity: 0.4 + 0.6 * random(),
    };
  });
}

/** Pixels of a tile that lie in the layer. */
function* pixelsOf(column: number, row: number): Generator<readonly [number, number]> {
  for (let y = row * TILE_PX; y < Math.min(SIZE.heightPx, (row + 1) * TILE_PX); y++)
    for (let x = column * TILE_PX; x < Math.min(SIZE.widthPx, (column + 1) * TILE_PX); x++) yield [x, y];
}

describe('tile-costs', () => {
  for (const [recordPrecision, isStacked] of [
    ['f32', false],
    ['paper', false],
    ['f32', true],
  ] as const) {
    gpuTest(
      `records of ${recordPrecision}${isStacked ? ', merged' : ''}: counts and contributions as the reference's, at every pixel`,
      async () => {
        const { records, pairs, counts, entries, contributionsPx, map } = await run(
          isStacked ? splats(300).map(merged) : splats(300),
          recordPrecision,
          { isStacked },
        );
        const floats = new Float32Array(map.buffer);
        const expectedPx = records.map(() => 0);
        let [compared, ended, unseen] = [0, 0, 0];
        for (let tileAt = 0; tileAt < TILE_COUNT; tileAt++) {
          const [column, row] = [tileAt % TILE_COLUMNS, Math.floor(tileAt / TILE_COLUMNS)];
          const bin = Math.floor(row / BIN_TILES) * pairs.binColumns + Math.floor(column / BIN_TILES);
          const tile = (row % BIN_TILES) * BIN_TILES + (column % BIN_TILES);
          const ranks = pairs.listOf(bin, tile).map((pair) => pairs.ranks[pair]);
          const listed = ranks.map((rank) => records[rank]);
          expect(entries[tileAt], `tile ${tileAt}`).toBe(listed.length);
          // An assertion for each of the pixels would take longer than the reference.
          for (const [x, y] of pixelsOf(column, row)) {
            const place = `column ${x}, row ${y}`;
            const at = y * SIZE.widthPx + x;
            const reference = pixelCosts(listed, [x, y], ALPHA_CUTOFF);
            for (const [i, weight] of reference.weights.entries()) expectedPx[ranks[i]] += weight;
            const hidden = ranks.filter((rank) => {
              const [centerX, centerY] = records[rank].centerPx;
              return (
                contributionsPx[rank] < UNSEEN_PX && Math.floor(centerX) === x && Math.floor(centerY) === y
              );
            });
            if (map[2 * PIXELS + at] !== hidden.length)
              expect.fail(`${place}: ${map[2 * PIXELS + at]} hidden, not ${hidden.length}`);
            unseen += hidden.length;
            if (isDoubtful(listed, x, y)) continue;
            compared++;
            if (reference.steps < listed.length) ended++;
            const got = [0, 1, 2].map((plane) => counts[plane * PIXELS + at]);
            const wanted = [reference.steps, reference.blended, reference.fragments];
            if (got.some((count, i) => count !== wanted[i])) expect.fail(`${place}: ${got}, not ${wanted}`);
            const listedPx = ranks.map((rank) => contributionsPx[rank]);
            const mean = meanLogContribution(reference.weights, listedPx);
            if (!(Math.abs(floats[at] - mean) < 2e-3))
              expect.fail(`${place}: mean ${floats[at]}, not ${mean}`);
            const opacity = reference.weights.reduce((sum, weight) => sum + weight, 0);
            if (!(Math.abs(floats[PIXELS + at] - opacity) < 1e-4))
              expect.fail(`${place}: opacity ${floats[PIXELS + at]}, not ${opacity}`);
          }
        }
        // Each comparison has something to compare.
        expect(compared).toBeGreaterThan(PIXELS / 2);
        expect(ended).toBeGreaterThan(50);
        expect(unseen).toBeGreaterThan(5);
        for (const [rank, expected] of expectedPx.entries()) {
          // A splat has a few pixels at most where rounding decides.
          const bound = 1e-4 * expected + 10 * ALPHA_CUTOFF;
          expect(Math.abs(contributionsPx[rank] - expected), `rank ${rank}`).toBeLessThan(bound);
        }
      },
    );
  }

  gpuTest('contributions are carried into their second word, the same in every run', async () => {
    const solid = {
      centerPx: [37, 34],
      minorLengthPx: 1e4,
      majorLengthPx: 1e4,
      angle: 0,
      opacity: 1,
    } as const;
    const before = 2 ** 31;
    const runs = await Promise.all([run([solid], 'f32', { before }), run([solid], 'f32', { before })]);
    for (const { contributionsPx, pairs } of runs) {
      const listing = Array.from({ length: TILES * 4 }, (_, i) =>
        pairs.listOf(Math.floor(i / TILES), i % TILES),
      );
      expect(listing.some(({ length }) => length > 0)).toBe(true);
      const sum = contributionsPx[0] - (before * (2 ** 32 + 1)) / CONTRIBUTION_UNITS;
      expect(sum).toBeGreaterThan(100);
      expect(sum).toBeLessThan(PIXELS);
      expect(contributionsPx).toEqual(runs[0].contributionsPx);
    }
  });
});
