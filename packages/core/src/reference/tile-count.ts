import type { BinGrid } from '../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../data/layout/constants.ts';
import { type EllipseRecord, splatEllipse } from './splat-ellipse.ts';
import { touchedBins } from './tile-grid.ts';

const { TILE_COUNT_BLOCK } = SHADER_CONSTANTS;

/** Numbers of pairs, as tile-count writes them. */
export interface PairCounts {
  /** Per rank: pairs before it within its block. */
  readonly pairOffsets: Uint32Array;
  /** Pairs per block of TILE_COUNT_BLOCK ranks. */
  readonly blockPairs: Uint32Array;
}

/**
 * Reference of tile-count.
 *
 * @param ranked records, nearest first.
 * @param shift bins are 2^shift times as wide and high as those of the grid; default 0.
 */
export function tileCount(
  ranked: readonly EllipseRecord[],
  grid: BinGrid,
  alphaCutoff: number,
  shift = 0,
): PairCounts {
  const pairOffsets = new Uint32Array(ranked.length);
  const blockPairs = new Uint32Array(Math.ceil(ranked.length / TILE_COUNT_BLOCK));
  for (const [rank, record] of ranked.entries()) {
    const block = Math.floor(rank / TILE_COUNT_BLOCK);
    pairOffsets[rank] = blockPairs[block];
    blockPairs[block] += touchedBins(splatEllipse(record, alphaCutoff), grid, 0, shift).length;
  }
  return { pairOffsets, blockPairs };
}
