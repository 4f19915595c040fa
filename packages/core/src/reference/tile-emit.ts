import type { BinGrid } from '../data/layout/bin-grid.ts';
import { type EllipseRecord, splatEllipse } from './splat-ellipse.ts';
import { touchedBins } from './tile-grid.ts';

/** Pairs of a rank and a bin, nearest first. */
export interface Pairs {
  readonly bins: Uint32Array;
  readonly ranks: Uint32Array;
}

/**
 * Reference of tile-emit: pairs of `ranked` records, nearest first, each splat's bin by bin.
 *
 * @param shift bins are 2^shift times as wide and high as those of the grid; default 0.
 */
export function tileEmit(
  ranked: readonly EllipseRecord[],
  grid: BinGrid,
  alphaCutoff: number,
  shift = 0,
): Pairs {
  const pairs = ranked.flatMap((record, rank) =>
    touchedBins(splatEllipse(record, alphaCutoff), grid, 0, shift).map((bin) => [bin, rank] as const),
  );
  return {
    bins: Uint32Array.from(pairs, ([bin]) => bin),
    ranks: Uint32Array.from(pairs, ([, rank]) => rank),
  };
}
