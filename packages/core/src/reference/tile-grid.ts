import type { BinGrid } from '../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../data/layout/constants.ts';
import { type SplatEllipse, touchedColumns, touchedRows } from './splat-ellipse.ts';

const { BIN_PX } = SHADER_CONSTANTS;

/** Reference of lib/tile-grid.wgsl: bins that an ellipse touches, row by row. */
export function touchedBins(ellipse: SplatEllipse | null, grid: BinGrid, slackPx = 0): number[] {
  if (!ellipse) return [];
  const { binColumns, binRows } = grid;
  const bins: number[] = [];
  const [firstRow, lastRow] = touchedRows(ellipse, BIN_PX, binRows, slackPx);
  for (let row = firstRow; row <= lastRow; row++) {
    const rows = [row * BIN_PX + 0.5, (row + 1) * BIN_PX - 0.5] as const;
    const columns = { left: 0, widthPx: BIN_PX, columns: binColumns };
    const [first, last] = touchedColumns(ellipse, rows, columns, slackPx);
    for (let column = first; column <= last; column++) bins.push(row * binColumns + column);
  }
  return bins;
}
