import type { SizePx } from '../accuracy/accuracy.ts';
import { SHADER_CONSTANTS } from '../layout/constants.ts';

/** Columns and rows of the bins that cover a layer. */
export interface BinGrid {
  readonly binColumns: number;
  readonly binRows: number;
}

/** Returns the bins that cover a layer of this size; those at its right and lower edges may reach beyond it. */
export function binGridOf({ widthPx, heightPx }: SizePx): BinGrid {
  const { BIN_PX } = SHADER_CONSTANTS;
  return { binColumns: Math.ceil(widthPx / BIN_PX), binRows: Math.ceil(heightPx / BIN_PX) };
}
