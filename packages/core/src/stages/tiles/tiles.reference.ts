import { MAX_FRAGMENT_ALPHA } from '../../data/accuracy/accuracy.ts';
import type { BinGrid } from '../../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import {
  type EllipseRecord,
  type SplatEllipse,
  splatEllipse,
  touchedColumns,
  touchedRows,
} from '../../reference/splat-ellipse.ts';
import { stackedAlpha } from '../../reference/stacked-opacity.ts';

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
 * @param shift bins are 2^shift times as wide and high as in the grid; default 0.
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

/** Sums stop here. */
const MOST_PAIRS = 2 ** 30;
/** Share of the room that estimated pairs may take: the estimate of larger bins may be too low. */
const SPARE = 0.8;

/** Decision about one frame, as tile-plan writes it. */
export interface PairPlan {
  /** Per block of ranks: pairs before it. */
  readonly blockStarts: readonly number[];
  readonly neededPairs: number;
  /** Pairs of bins of that size; none if they do not fit, or are to be counted again. */
  readonly pairCount: number;
  readonly fits: boolean;
  readonly binShift: number;
  /** Splats that the quads draw. */
  readonly quads: number;
}

interface PlanOptions {
  readonly visibleCount: number;
  readonly pairCapacity: number;
  readonly grid: BinGrid;
  /** Of pairs that have been counted again: the plan before that. */
  readonly first?: PairPlan;
}

/** Reference of tile-plan. */
export function tilePlan(
  blockPairs: ArrayLike<number>,
  { visibleCount, pairCapacity, grid, first }: PlanOptions,
): PairPlan {
  let total = 0;
  const blockStarts = Array.from(blockPairs, (pairs) => {
    total += pairs;
    return total - pairs;
  });
  const whole = wholeShift(grid);
  const coarser = first ? whole : shiftFor(total, visibleCount, pairCapacity, whole);
  const binShift = total <= pairCapacity ? (first?.binShift ?? 0) : coarser;
  const isRanked = binShift > 0 && binShift === whole;
  const isKnown = first !== undefined || binShift === 0 || isRanked;
  const wanted = isRanked ? visibleCount : total;
  const fits = isKnown && wanted <= pairCapacity;
  return {
    blockStarts,
    neededPairs: first?.neededPairs ?? total,
    pairCount: fits ? wanted : 0,
    fits,
    binShift,
    quads: fits ? 0 : visibleCount,
  };
}

function shiftFor(total: number, visibleCount: number, pairCapacity: number, whole: number): number {
  const pairs = Math.min(total, MOST_PAIRS);
  for (let shift = 1; shift < whole; shift++) {
    const edges = (2 * Math.sqrt(visibleCount * pairs)) / 2 ** shift;
    if (pairs / 4 ** shift + edges + visibleCount <= SPARE * pairCapacity) return shift;
  }
  return whole;
}

/** Pairs of a rank and a bin, nearest first. */
export interface Pairs {
  readonly bins: Uint32Array;
  readonly ranks: Uint32Array;
}

/**
 * Reference of tile-emit: pairs of `ranked` records, nearest first, each splat's bin by bin.
 *
 * @param shift bins are 2^shift times as wide and high as in the grid; default 0.
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

/** Reference of tile-ranges: the first sorted pair of each bin, and the end of the last. */
export function tileRanges(sortedBins: ArrayLike<number>, binCount: number): Uint32Array {
  const starts = new Uint32Array(binCount + 1);
  for (let i = 0; i < sortedBins.length; i++) if (sortedBins[i] < binCount) starts[sortedBins[i] + 1]++;
  for (let bin = 0; bin < binCount; bin++) starts[bin + 1] += starts[bin];
  return starts;
}

const { BIN_TILES, TILE_PX, BIN_PX } = SHADER_CONSTANTS;

/**
 * Reference of tile-masks for one pair: its tiles by row; `slackPx` as in `touchedColumns`.
 *
 * @param shift bins, and blocks of tiles, are 2^shift times as wide and high as usual.
 */
export function touchedTiles(
  ellipse: SplatEllipse | null,
  bin: { readonly column: number; readonly row: number },
  slackPx = 0,
  shift = 0,
): number[] {
  if (!ellipse) return [];
  const tiles: number[] = [];
  const [binPx, blockPx] = [BIN_PX * 2 ** shift, TILE_PX * 2 ** shift];
  for (let row = 0; row < BIN_TILES; row++) {
    const top = bin.row * binPx + row * blockPx;
    const rows = [top + 0.5, top + blockPx - 0.5] as const;
    const columns = { left: bin.column * binPx, widthPx: blockPx, columns: BIN_TILES };
    const [first, last] = touchedColumns(ellipse, rows, columns, slackPx);
    for (let column = first; column <= last; column++) tiles.push(row * BIN_TILES + column);
  }
  return tiles;
}

/** A pixel ends when less of the light behind it passes through. */
export const OPAQUE = 2 ** -16;

/** A record as a tile blends it. */
export interface BlendedRecord extends EllipseRecord {
  readonly depthView: number;
}

/** A blended pixel. */
export interface TilePixel {
  /** Premultiplied r, g, b, and opacity. */
  readonly rgba: readonly [number, number, number, number];
  /**
   * Median depth: the view depth of the splat that makes the pixel more than half covered, or of
   * the last one, times the opacity.
   */
  readonly depthView: number;
  /** Number of records that were looked at before the pixel ended. */
  readonly tested: number;
}

/**
 * Reference of tile-rasterize for one pixel: blends records front to back.
 *
 * @param ranked records, nearest first.
 * @param hostDepthView view depth behind which splats are hidden; default nothing is.
 */
export function tilePixel(
  ranked: readonly BlendedRecord[],
  [xPx, yPx]: readonly [number, number],
  alphaCutoff: number,
  hostDepthView = Number.POSITIVE_INFINITY,
): TilePixel {
  const rgb: [number, number, number] = [0, 0, 0];
  let [transmittance, depthView, tested] = [1, 0, 0];
  for (const record of ranked) {
    if (transmittance < OPAQUE) break;
    tested++;
    const alpha = alphaAt(record, xPx, yPx);
    if (alpha < alphaCutoff || record.depthView > hostDepthView) continue;
    const weight = alpha * transmittance;
    for (let channel = 0; channel < 3; channel++) rgb[channel] += record.color[channel] * weight;
    if (transmittance > 0.5) ({ depthView } = record);
    transmittance -= weight;
  }
  return { rgba: [...rgb, 1 - transmittance], depthView: depthView * (1 - transmittance), tested };
}

/** Opacity of a record at the centre of a pixel. */
export function alphaAt(record: EllipseRecord, xPx: number, yPx: number): number {
  const { centerPx, majorPx, minorPx, color } = record;
  const [x, y] = [xPx + 0.5 - centerPx[0], yPx + 0.5 - centerPx[1]];
  const area = majorPx[0] * minorPx[1] - majorPx[1] * minorPx[0];
  const along = (x * minorPx[1] - y * minorPx[0]) / area;
  const across = (majorPx[0] * y - majorPx[1] * x) / area;
  const gaussian = Math.exp(-(along * along + across * across));
  return Math.min(MAX_FRAGMENT_ALPHA, stackedAlpha(color[3], gaussian));
}

/**
 * Reference of lib/tile-grid.wgsl: bins that an ellipse touches, row by row.
 *
 * @param shift bins have 2^shift times the grid's bin width and height.
 */
export function touchedBins(ellipse: SplatEllipse | null, grid: BinGrid, slackPx = 0, shift = 0): number[] {
  if (!ellipse) return [];
  const { binColumns, binRows } = largerBins(grid, shift);
  const binPx = SHADER_CONSTANTS.BIN_PX * 2 ** shift;
  const bins: number[] = [];
  const [firstRow, lastRow] = touchedRows(ellipse, binPx, binRows, slackPx);
  for (let row = firstRow; row <= lastRow; row++) {
    const rows = [row * binPx + 0.5, (row + 1) * binPx - 0.5] as const;
    const columns = { left: 0, widthPx: binPx, columns: binColumns };
    const [first, last] = touchedColumns(ellipse, rows, columns, slackPx);
    for (let column = first; column <= last; column++) bins.push(row * binColumns + column);
  }
  return bins;
}

/** The grid of bins that are 2^shift times as wide and high. */
export function largerBins({ binColumns, binRows }: BinGrid, shift: number): BinGrid {
  return { binColumns: Math.ceil(binColumns / 2 ** shift), binRows: Math.ceil(binRows / 2 ** shift) };
}

/** Shift at which one bin covers the layer. */
export function wholeShift({ binColumns, binRows }: BinGrid): number {
  return Math.ceil(Math.log2(Math.max(binColumns, binRows)));
}
