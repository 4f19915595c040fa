import { SHADER_CONSTANTS } from './constants.ts';

/** Columns and rows of the bins that cover a layer. */
export interface BinGrid {
  readonly binColumns: number;
  readonly binRows: number;
}

/** Returns the bins that cover a layer of this size, px; those at its right and lower edges may reach beyond it. */
export function binGrid(widthPx: number, heightPx: number): BinGrid {
  const { BIN_PX } = SHADER_CONSTANTS;
  return { binColumns: Math.ceil(widthPx / BIN_PX), binRows: Math.ceil(heightPx / BIN_PX) };
}
