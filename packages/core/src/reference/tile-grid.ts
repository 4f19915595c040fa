import type { BinGrid } from '../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../data/layout/constants.ts';
import { type SplatEllipse, touchedColumns, touchedRows } from './splat-ellipse.ts';

const { BIN_PX } = SHADER_CONSTANTS;

/**
 * Reference of lib/tile-grid.wgsl: bins that an ellipse touches, row by row.
 *
 * @param shift bins have 2^shift times the grid's bin width and height.
 */
export function touchedBins(ellipse: SplatEllipse | null, grid: BinGrid, slackPx = 0, shift = 0): number[] {
  if (!ellipse) return [];
  const { binColumns, binRows } = largerBins(grid, shift);
  const binPx = BIN_PX * 2 ** shift;
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
