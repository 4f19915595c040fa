import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import type { RecordPrecision, SizePx } from '../../data/accuracy/accuracy.ts';
import { binGrid } from '../../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { TilePlan } from '../../data/layout/structs.ts';
import { type DrawnSplat, rankedBuffers, rankedRecords } from '../../testing/ranked-records.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { anySplat, hasClearBins, merged, tileUniforms } from '../../testing/tile-buffers.ts';
import { dispatchSize } from '../dispatch.ts';
import { sortHistogram } from '../sort/sort.reference.ts';
import { blockKeysOf, pairSortShapeFor } from '../sort/sort.ts';
import {
  tileEmit as emitReference,
  type PairCounts,
  type Pairs,
  tileCount,
  tilePlan,
  wholeShift,
} from './tiles.reference.ts';
import { tileEmit } from './tiles.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';
const ALPHA_CUTOFF = 1 / 255;
/** 70 bins. */
const SIZE = { widthPx: 610, heightPx: 395 };
/** 672 bins: the first of two passes of the sort sees only a part of a key. */
const LARGE_SIZE = { widthPx: 2040, heightPx: 1290 };
const UNWRITTEN = 0xffffffff;

const gpu = testGpu();

const faint = (splat: DrawnSplat): DrawnSplat => ({ ...splat, opacity: 0.003 });

/**
 * Splats without rounding at the borders of bins: some at the ends and in long runs too faint, some
 * over the whole layer.
 */
function splats(
  count: number,
  size: SizePx,
  precision: RecordPrecision,
  isStacked = false,
  binShift = 0,
): DrawnSplat[] {
  const random = seededRandom(count);
  const grid = binGrid(size.widthPx, size.heightPx);
  const lengthPx = 200 * size.widthPx;
  const huge = {
    centerPx: [700, -90],
    majorLengthPx: lengthPx,
    minorLengthPx: lengthPx / 2,
    angle: 2,
  } as const;
  const isFaint = (i: number) => i < 7 || i > count - 9 || (i > count / 2 && i < count / 2 + 90);
  const all = Array.from({ length: count }, (_, i) => {
    const splat = isStacked ? merged(anySplat(random, size), i) : anySplat(random, size);
    if (i % 400 === 50) return { ...huge, opacity: 0.8 };
    return isFaint(i) ? faint(splat) : splat;
  });
  const { records } = rankedRecords(all, precision);
  return all.filter((_, i) => hasClearBins(records[i], grid, ALPHA_CUTOFF, binShift));
}

interface EmitOptions {
  readonly ranked: readonly DrawnSplat[];
  readonly size: SizePx;
  readonly precision: RecordPrecision;
  readonly isStacked?: boolean;
  /** Bins are 2^binShift times as wide and high; default 0. */
  readonly binShift?: number;
  /** Changes the reference's counts, as if tile-count had rounded otherwise. */
  readonly miscount?: (counts: PairCounts) => void;
}

/** Lists pairs on the GPU: the same by the shader for narrow subgroups. */
async function emit(options: EmitOptions) {
  const { ranked, size, precision, isStacked, binShift = 0, miscount = () => {} } = options;
  const grid = binGrid(size.widthPx, size.heightPx);
  const binCount = grid.binColumns * grid.binRows;
  const shape = pairSortShapeFor(Math.ceil(Math.log2(binCount + 1)));
  const packed = rankedRecords(ranked, precision);
  const counts = tileCount(packed.records, grid, ALPHA_CUTOFF, binShift);
  miscount(counts);
  const visibleCount = ranked.length;
  const { blockStarts, neededPairs } = tilePlan(counts.blockPairs, {
    visibleCount,
    pairCapacity: 2 ** 30,
    grid,
  });
  const isRanked = binShift > 0 && binShift === wholeShift(grid);
  const pairCount = isRanked ? visibleCount : neededPairs;
  const plan = TilePlan.pack({ neededPairs, pairCount, fits: 1, visibleCount, binShift });
  const blockKeys = blockKeysOf(shape);
  const blockCount = Math.ceil(pairCount / blockKeys);
  const { digitBits } = shape;
  const unwritten = (count: number) => gpu.storage(new Uint32Array(count).fill(UNWRITTEN));
  const dispatchRow = 2;
  const inputs = {
    ...tileUniforms(gpu, { size, alphaCutoff: ALPHA_CUTOFF, dispatchRow }),
    ...rankedBuffers(gpu, packed),
    tilePlan: gpu.storage(new Uint32Array(plan)),
    pairOffsets: gpu.storage(counts.pairOffsets),
    blockPairs: gpu.storage(blockStarts),
  };
  const run = async (isNarrow: boolean) => {
    const outputs = {
      pairBins: unwritten(pairCount + 1),
      pairRecords: unwritten(pairCount + 1),
      digitCounts: unwritten((blockCount << digitBits) + 1),
    };
    const stage = tileEmit({ recordPrecision: precision, extent: 'opacity', isStacked, isNarrow }, shape);
    // Workgroups behind the last block must do nothing.
    await gpu.run(stage, { ...inputs, ...outputs }, dispatchSize(blockCount + 3, dispatchRow));
    return {
      bins: await gpu.read(outputs.pairBins),
      records: await gpu.read(outputs.pairRecords),
      digitCounts: await gpu.read(outputs.digitCounts),
    };
  };
  const actual = await run(false);
  expect(await run(true)).toEqual(actual);
  return {
    reference: emitReference(packed.records, grid, ALPHA_CUTOFF, binShift),
    places: packed.places,
    pass: { digitShift: 0, digitBits, blockKeys },
    binCount,
    blockCount,
    actual,
  };
}

/** Checks that the GPU wrote these pairs, their digits, and nothing else. */
function expectPairs(
  { actual, places, pass }: Awaited<ReturnType<typeof emit>>,
  { bins, ranks }: Pairs,
): void {
  const withEnd = (words: ArrayLike<number>) => {
    const ended = new Uint32Array(words.length + 1).fill(UNWRITTEN);
    ended.set(words);
    return ended;
  };
  expect(actual.bins).toEqual(withEnd(bins));
  expect(actual.records).toEqual(withEnd(Array.from(ranks, (rank) => places[rank])));
  expect(actual.digitCounts).toEqual(withEnd(sortHistogram(bins, pass)));
}

describe('tile-emit', () => {
  for (const precision of ['f32', 'f16', 'paper'] as const) {
    for (const [name, size, count] of [
      ['one pass', SIZE, 6000],
      ['two passes', LARGE_SIZE, 4000],
    ] as const) {
      // In the first tier, each precision, and each number of passes twice.
      if (!isFull && (precision === 'f16' ? size !== SIZE : precision === 'paper' && size === SIZE)) continue;
      gpuTest(
        `${precision}, ${name}: lists the reference's pairs in several blocks, and counts their digits`,
        { tags: 'deeper' },
        async () => {
          const result = await emit({ ranked: splats(count, size, precision), size, precision });
          expect(result.blockCount).toBeGreaterThan(2);
          expectPairs(result, result.reference);
        },
      );
    }
  }

  gpuTest('pairs of merged splats among others', async () => {
    const ranked = splats(3000, SIZE, 'f32', true);
    const result = await emit({ ranked, size: SIZE, precision: 'f32', isStacked: true });
    expectPairs(result, result.reference);
  });

  gpuTest('pairs of larger bins', async () => {
    for (const binShift of [1, 2, 3]) {
      const ranked = splats(6000, SIZE, 'f32', false, binShift);
      const result = await emit({ ranked, size: SIZE, precision: 'f32', binShift });
      expect(result.blockCount).toBeGreaterThan(1);
      expectPairs(result, result.reference);
    }
  });

  gpuTest('a pair of each splat, in order, where one bin is the layer', async () => {
    const ranked = splats(6000, SIZE, 'f32');
    const result = await emit({ ranked, size: SIZE, precision: 'f32', binShift: 4 });
    expect(result.blockCount).toBeGreaterThan(1);
    const ranks = Uint32Array.from(ranked.keys());
    expectPairs(result, { bins: new Uint32Array(ranks.length), ranks });
  });

  gpuTest('pairs of a single splat over many bins, in more than one block', async () => {
    const size = { widthPx: 64 * 90, heightPx: 64 * 80 };
    const over = { majorLengthPx: 1e5, minorLengthPx: 9e4, angle: 1, opacity: 0.9 };
    const result = await emit({ ranked: [{ centerPx: [9, 9], ...over }], size, precision: 'f32' });
    expect(result.blockCount).toBeGreaterThan(1);
    expect(result.reference.bins).toHaveLength(90 * 80);
    expectPairs(result, result.reference);
  });

  gpuTest('one pair, and none', async () => {
    const dot = { centerPx: [300, 90], majorLengthPx: 2, minorLengthPx: 1, angle: 1, opacity: 0.5 } as const;
    const one = await emit({ ranked: [faint(dot), dot, faint(dot)], size: SIZE, precision: 'f16' });
    expectPairs(one, { bins: Uint32Array.of(14), ranks: Uint32Array.of(1) });
    const none = await emit({ ranked: [faint(dot)], size: SIZE, precision: 'f16' });
    expectPairs(none, { bins: new Uint32Array(), ranks: new Uint32Array() });
  });

  gpuTest('thousands of splats without pairs between those that have some', async () => {
    // Five times as many ranks in a block as workgroup memory has samples of.
    const count = 5 * SHADER_CONSTANTS.RANK_SAMPLES;
    const ranked = splats(count, SIZE, 'f32').map((splat, i) => (i % 11 === 3 ? splat : faint(splat)));
    const result = await emit({ ranked, size: SIZE, precision: 'f32' });
    expect(result.blockCount).toBe(1);
    expectPairs(result, result.reference);
  });

  gpuTest('pairs that were counted but are not found get a key behind all bins', async () => {
    const ranked = splats(900, SIZE, 'f32');
    const grid = binGrid(SIZE.widthPx, SIZE.heightPx);
    const { pairOffsets } = tileCount(rankedRecords(ranked, 'f32').records, grid, ALPHA_CUTOFF);
    const drawn = Array.from(ranked.keys()).filter((rank) => ranked[rank].opacity > 0.1);
    const isOutside = (rank: number) => pairOffsets[rank] === pairOffsets[rank + 1];
    // Two pairs too many of each of some splats, among them two without any.
    const inside = drawn.filter((rank) => !isOutside(rank));
    const outside = drawn.filter(isOutside);
    const miscounted = [inside[3], inside[120], outside[9], outside[40]].toSorted((a, b) => a - b);
    const result = await emit({
      ranked,
      size: SIZE,
      precision: 'f32',
      miscount: ({ pairOffsets, blockPairs }) => {
        for (const first of miscounted) {
          for (let rank = first + 1; rank < pairOffsets.length; rank++) pairOffsets[rank] += 2;
          blockPairs[0] += 2;
        }
      },
    });
    expect(ranked.length).toBeLessThan(1024);
    const { reference, binCount } = result;
    const expected = Array.from(reference.bins, (bin, i) => ({ bin, rank: reference.ranks[i] }));
    for (const rank of miscounted) {
      const behind = expected.findIndex((pair) => pair.rank > rank);
      expected.splice(behind, 0, { bin: binCount, rank }, { bin: binCount, rank });
    }
    expectPairs(result, {
      bins: Uint32Array.from(expected, ({ bin }) => bin),
      ranks: Uint32Array.from(expected, ({ rank }) => rank),
    });
  });
});
