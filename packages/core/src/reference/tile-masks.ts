import { SHADER_CONSTANTS } from '../data/layout/constants.ts';
import { type SplatEllipse, touchedColumns } from './splat-ellipse.ts';

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
