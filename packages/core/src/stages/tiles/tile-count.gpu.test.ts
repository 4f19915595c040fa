import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import type { Extent, RecordPrecision } from '../../data/accuracy/accuracy.ts';
import { binGrid } from '../../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { TilePlan } from '../../data/layout/structs.ts';
import type { EllipseRecord } from '../../reference/splat-ellipse.ts';
import {
  type DrawnSplat,
  type RankedRecord,
  rankedBuffers,
  rankedRecords,
} from '../../testing/ranked-records.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { anySplat, binsOf, hasClearBins, merged, tileUniforms } from '../../testing/tile-buffers.ts';
import { dispatchSize } from '../dispatch.ts';
import { tileCount as countReference } from './tiles.reference.ts';
import { tileCount } from './tiles.ts';

const { TILE_COUNT_BLOCK } = SHADER_CONSTANTS;
const ALPHA_CUTOFF = 1 / 255;
const SIZE = { widthPx: 610, heightPx: 395 };
const GRID = binGrid(SIZE.widthPx, SIZE.heightPx);
/** Covers the whole layer. */
const HUGE: DrawnSplat = {
  centerPx: [-300, 900],
  majorLengthPx: 1e5,
  minorLengthPx: 9e4,
  angle: 1,
  opacity: 0.9,
};

const gpu = testGpu();

const RECORD_PRECISIONS: readonly RecordPrecision[] = ['f32', 'f16', 'paper'];

/** Splats with a huge one among them, nearest first. */
function splats(count: number): DrawnSplat[] {
  const random = seededRandom(count);
  return Array.from({ length: count }, (_, i) => (i === 5 ? HUGE : anySplat(random, SIZE)));
}

interface CountOptions {
  readonly ranked: readonly DrawnSplat[];
  readonly recordPrecision: RecordPrecision;
  readonly extent?: Extent;
  readonly isStacked?: boolean;
  /** Of the plan, for counting again; undefined for counting. */
  readonly binShift?: number;
  /** Which of the records to count; default all. */
  readonly isCounted?: (record: RankedRecord) => boolean;
}

/** Counts the pairs of splats on the GPU: the same by the shader for narrow subgroups. */
async function count(options: CountOptions) {
  const { ranked, recordPrecision, extent = 'opacity', isStacked, isCounted = () => true } = options;
  const { binShift } = options;
  const { records } = rankedRecords(ranked, recordPrecision);
  const counted = rankedRecords(
    ranked.filter((_, rank) => isCounted(records[rank])),
    recordPrecision,
  );
  const blockCount = Math.ceil(counted.records.length / TILE_COUNT_BLOCK);
  const dispatchRow = 2;
  const inputs = {
    ...tileUniforms(gpu, { size: SIZE, alphaCutoff: ALPHA_CUTOFF, dispatchRow }),
    ...rankedBuffers(gpu, counted),
    ...(binShift !== undefined && {
      tilePlan: gpu.storage(
        new Uint32Array(TilePlan.pack({ neededPairs: 0, pairCount: 0, fits: 0, visibleCount: 0, binShift })),
      ),
    }),
  };
  // Workgroups behind the last block must do nothing.
  const workgroups = dispatchSize(blockCount + 2, dispatchRow);
  const run = async (isNarrow: boolean) => {
    const pairOffsets = gpu.storage([], 4 * counted.records.length);
    const blockPairs = gpu.storage([], 4 * blockCount);
    const stage = tileCount({ recordPrecision, extent, isStacked, isNarrow }, binShift !== undefined);
    await gpu.run(stage, { ...inputs, pairOffsets, blockPairs }, workgroups);
    return { pairOffsets: await gpu.read(pairOffsets), blockPairs: await gpu.read(blockPairs) };
  };
  const actual = await run(false);
  expect(await run(true)).toEqual(actual);
  return { records: counted.records, actual };
}

/** Number of pairs of each rank. */
function pairsPerRank({ pairOffsets, blockPairs }: Awaited<ReturnType<typeof count>>['actual']): number[] {
  return Array.from(pairOffsets, (before, rank) => {
    const isLast = rank + 1 === pairOffsets.length || (rank + 1) % TILE_COUNT_BLOCK === 0;
    return (isLast ? blockPairs[Math.floor(rank / TILE_COUNT_BLOCK)] : pairOffsets[rank + 1]) - before;
  });
}

describe('tile-count', () => {
  for (const recordPrecision of RECORD_PRECISIONS) {
    gpuTest(`${recordPrecision}: exactly the reference's pairs of splats whose bins are clear`, async () => {
      const isCounted = (record: RankedRecord) => hasClearBins(record, GRID, ALPHA_CUTOFF);
      const { records, actual } = await count({ ranked: splats(3200), recordPrecision, isCounted });
      expect(records.length).toBeGreaterThan(2 * TILE_COUNT_BLOCK);
      expect(actual).toEqual(countReference(records, GRID, ALPHA_CUTOFF));
      const ranked = splats(1500).map(merged);
      const stacked = await count({ ranked, recordPrecision, isCounted, isStacked: true });
      expect(stacked.actual).toEqual(countReference(stacked.records, GRID, ALPHA_CUTOFF));
      const pairs = pairsPerRank(actual);
      expect(Math.max(...pairs)).toBe(GRID.binColumns * GRID.binRows);
      expect(pairs.filter((each) => each === 0).length).toBeGreaterThan(records.length / 5);
    });
  }

  gpuTest('never fewer pairs than the reference, nor more than a widened ellipse has', async () => {
    for (const isStacked of [false, true]) {
      const ranked = isStacked ? splats(3000).map(merged) : splats(3000);
      const { records, actual } = await count({ ranked, recordPrecision: 'f32', isStacked });
      for (const [rank, pairs] of pairsPerRank(actual).entries()) {
        const { least, most } = binsOf(records[rank], GRID, ALPHA_CUTOFF);
        expect(pairs, `rank ${rank}`).toBeGreaterThanOrEqual(least.length);
        expect(pairs, `rank ${rank}`).toBeLessThanOrEqual(most.length);
      }
    }
  });

  gpuTest(
    'a fixed extent reaches as far as that of an opaque splat, or of a merged one, if it is drawn at all',
    async () => {
      const asCounted = (record: RankedRecord): EllipseRecord =>
        record.color[3] < ALPHA_CUTOFF
          ? record
          : { ...record, color: [1, 1, 1, Math.max(1, record.color[3])] };
      const isCounted = (record: RankedRecord) => hasClearBins(asCounted(record), GRID, ALPHA_CUTOFF);
      const options = { recordPrecision: 'f16', extent: 'fixed', isCounted } as const;
      for (const isStacked of [false, true]) {
        const ranked = isStacked ? splats(1500).map(merged) : splats(1500);
        const { records, actual } = await count({ ...options, ranked, isStacked });
        expect(actual).toEqual(countReference(records.map(asCounted), GRID, ALPHA_CUTOFF));
        expect(actual).not.toEqual(countReference(records, GRID, ALPHA_CUTOFF));
      }
    },
  );

  gpuTest('the pairs of larger bins, where the plan has them, and they are more than one', async () => {
    for (const binShift of [1, 2, 3]) {
      const isCounted = (record: RankedRecord) => hasClearBins(record, GRID, ALPHA_CUTOFF, binShift);
      const ranked = splats(2000);
      const { records, actual } = await count({ ranked, recordPrecision: 'f32', binShift, isCounted });
      expect(actual).toEqual(countReference(records, GRID, ALPHA_CUTOFF, binShift));
    }
    for (const binShift of [0, 4]) {
      const { actual } = await count({ ranked: splats(50), recordPrecision: 'f32', binShift });
      expect(actual.blockPairs).toEqual(Uint32Array.of(0));
    }
  });

  gpuTest('any number of splats up to a block and a little more', async () => {
    const isCounted = (record: RankedRecord) => hasClearBins(record, GRID, ALPHA_CUTOFF);
    const clear = splats(1400).filter((splat) => isCounted(rankedRecords([splat], 'f32').records[0]));
    for (const length of [1, 2, TILE_COUNT_BLOCK - 1, TILE_COUNT_BLOCK, TILE_COUNT_BLOCK + 1]) {
      const { records, actual } = await count({ ranked: clear.slice(0, length), recordPrecision: 'f32' });
      expect(records).toHaveLength(length);
      expect(actual).toEqual(countReference(records, GRID, ALPHA_CUTOFF));
    }
  });
});
