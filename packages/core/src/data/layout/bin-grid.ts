import { SHADER_CONSTANTS } from './constants.ts';

/** Columns and rows of the bins that cover a layer. */
export interface BinGrid {
  readonly binColumns: number;
  readonly binRows: number;
}

/** Returns the bins over a layer of this size, px; the last of each axis may exceed it. */
export function binGrid(widthPx: number, heightPx: number): BinGrid {
  const { BIN_PX } = SHADER_CONSTANTS;
  return { binColumns: Math.ceil(widthPx / BIN_PX), binRows: Math.ceil(heightPx / BIN_PX) };
}
