import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import type { RecordPrecision } from '../../data/accuracy/accuracy.ts';
import { binGrid } from '../../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { TilePlan } from '../../data/layout/structs.ts';
import { splatEllipse } from '../../reference/splat-ellipse.ts';
import { rankedBuffers, rankedRecords } from '../../testing/ranked-records.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import {
  anySplat,
  binsOf,
  merged,
  mostSlackPx,
  tilesOfPair,
  tileUniforms,
} from '../../testing/tile-buffers.ts';
import { dispatchSize } from '../dispatch.ts';
import { largerBins, touchedTiles, wholeShift } from './tiles.reference.ts';
import { tileMasks } from './tiles.ts';

const { BIN_TILES, MASK_GROUP } = SHADER_CONSTANTS;
const TILES = BIN_TILES * BIN_TILES;
const GROUP_WORDS = (TILES * MASK_GROUP) / 32;
const ALPHA_CUTOFF = 1 / 255;
const SIZE = { widthPx: 330, heightPx: 201 };
const GRID = binGrid(SIZE.widthPx, SIZE.heightPx);
const UNWRITTEN = 0x12345678;

const gpu = testGpu();

/**
 * Pairs of splats of every size with the bins that they touch, and with one that they do not; the
 * first `pairCount`.
 */
async function mask(
  pairCount: number,
  recordPrecision: RecordPrecision,
  { isStacked = false, binShift = 0 } = {},
) {
  const random = seededRandom(pairCount);
  const packed = rankedRecords(
    Array.from({ length: Math.max(16, pairCount) }, (_, i) =>
      isStacked ? merged(anySplat(random, SIZE), i) : anySplat(random, SIZE),
    ),
    recordPrecision,
  );
  const pairs = packed.records
    .flatMap((record, rank) => {
      // Where one bin is the layer, those too faint to be drawn are listed as well.
      if (binShift === wholeShift(GRID)) return [{ bin: 0, rank }];
      const { binColumns, binRows } = largerBins(GRID, binShift);
      const { most } = binsOf(record, GRID, ALPHA_CUTOFF, binShift);
      const drawn = record.color[3] >= ALPHA_CUTOFF;
      return (drawn ? [...most, rank % (binColumns * binRows)] : []).map((bin) => ({ bin, rank }));
    })
    .slice(0, pairCount);
  expect(pairs).toHaveLength(pairCount);
  // Pairs of an earlier frame, which touch tiles, lie behind this frame's.
  const inBuffer = [
    ...pairs,
    ...Array<(typeof pairs)[number]>(MASK_GROUP).fill(pairs[0] ?? { bin: 0, rank: 0 }),
  ];
  const groups = Math.ceil(pairCount / MASK_GROUP);
  const counts = { neededPairs: pairCount, pairCount, fits: 1, visibleCount: pairCount };
  const plan = TilePlan.pack({ ...counts, binShift });
  const unwritten = new Uint32Array(groups * GROUP_WORDS + 1).fill(UNWRITTEN);
  const words = gpu.storage(unwritten);
  const dispatchRow = 2;
  const { records } = rankedBuffers(gpu, packed);
  const bindings = {
    ...tileUniforms(gpu, { size: SIZE, alphaCutoff: ALPHA_CUTOFF, dispatchRow }),
    tilePlan: gpu.storage(new Uint32Array(plan)),
    sortedBins: gpu.storage(inBuffer.map(({ bin }) => bin)),
    sortedRecords: gpu.storage(inBuffer.map(({ rank }) => packed.places[rank])),
    records,
    tileMasks: words,
  };
  const found = [];
  for (const isNarrow of [false, true]) {
    gpu.device.queue.writeBuffer(words, 0, unwritten);
    const stage = tileMasks({ recordPrecision, extent: 'opacity', isStacked, isNarrow });
    // Workgroups behind the last group must do nothing.
    await gpu.run(stage, bindings, dispatchSize(groups + 3, dispatchRow));
    found.push(await gpu.read(words));
  }
  const [masks, narrow] = found;
  expect(narrow).toEqual(masks);
  expect(masks.at(-1)).toBe(UNWRITTEN);
  return { masks, pairs: pairs.map(({ bin, rank }) => ({ bin, record: packed.records[rank] })), groups };
}

type Tiles = readonly number[];

/** Expects a pair to have all tiles of `least`, and none beside `most`. */
function expectBetween(pair: number, least: Tiles, found: Tiles, most: Tiles): void {
  const missing = least.filter((tile) => !found.includes(tile));
  const extra = found.filter((tile) => !most.includes(tile));
  // Vitest would take longer for an assertion per pair than the GPU for all pairs.
  if (missing.length + extra.length > 0) expect.fail(`pair ${pair}: without ${missing}, with ${extra}`);
}

describe('tile-masks', () => {
  for (const [recordPrecision, isStacked] of [
    ['f32', false],
    ['f16', false],
    ['paper', false],
    ['f32', true],
    ['f16', true],
  ] as const) {
    const name = `${recordPrecision}${isStacked ? ', merged' : ''}`;
    gpuTest(`${name}: a bit for each tile that a pair touches, and hardly any other`, async () => {
      const { masks, pairs } = await mask(5 * MASK_GROUP + 77, recordPrecision, { isStacked });
      let [clear, bits] = [0, 0];
      for (const [i, { bin, record }] of pairs.entries()) {
        const ellipse = splatEllipse(record, ALPHA_CUTOFF)!;
        const place = { column: bin % GRID.binColumns, row: Math.floor(bin / GRID.binColumns) };
        const least = touchedTiles(ellipse, place);
        const most = touchedTiles(ellipse, place, mostSlackPx(ellipse));
        const found = tilesOfPair(masks, i);
        expectBetween(i, least, found, most);
        bits += found.length;
        if (least.length === most.length) clear++;
      }
      // The two bounds are the same for most pairs, which are exact then.
      expect(clear).toBeGreaterThan(0.8 * pairs.length);
      expect(bits).toBeGreaterThan(5000);
    });
  }

  gpuTest('larger bins: a bit for each block that a pair touches, and hardly any other', async () => {
    for (const binShift of [1, 2, 3]) {
      const { masks, pairs } = await mask(5 * MASK_GROUP + 77, 'f32', { binShift });
      const { binColumns } = largerBins(GRID, binShift);
      let [bits, faint] = [0, 0];
      for (const [i, { bin, record }] of pairs.entries()) {
        const ellipse = splatEllipse(record, ALPHA_CUTOFF);
        const place = { column: bin % binColumns, row: Math.floor(bin / binColumns) };
        const within = (slackPx: number) => touchedTiles(ellipse, place, slackPx, binShift);
        const found = tilesOfPair(masks, i);
        expectBetween(i, within(0), found, within(ellipse ? mostSlackPx(ellipse) : 0));
        bits += found.length;
        if (!ellipse) faint++;
      }
      expect(faint > 50).toBe(binShift === wholeShift(GRID));
      expect(bits).toBeGreaterThan(3000);
    }
  });

  gpuTest('no bits behind the last pair, whose word may be shared', async () => {
    for (const pairCount of [1, 31, 33, MASK_GROUP, MASK_GROUP + 1]) {
      const { masks, groups } = await mask(pairCount, 'f32');
      for (let pair = pairCount; pair < groups * MASK_GROUP; pair++)
        expect(tilesOfPair(masks, pair), `${pairCount} pairs, pair ${pair}`).toEqual([]);
    }
  });

  gpuTest('writes nothing if there are no pairs', async () => {
    const { groups } = await mask(0, 'f32');
    expect(groups).toBe(0);
  });
});
