import type { SplatCells } from '../../data/bricks/leaf-scene.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { reasonToDrop } from '../../data/splats/splat-row.ts';
import type { ShDegree } from '../../data/splats/splat-set.ts';
import { SMOOTH_BUSY_MS, Turns } from '../../data/turns.ts';
import type { SceneWorkers } from '../loading/scene-workers.ts';
import { type CellColumns, widthOf } from './cell-columns.ts';

/** Most splats per piece. */
const PIECE_SPLATS = LEVEL_CONSTANTS.CELL_CHILDREN * CHUNK_SPLATS;
/** Most pieces that wait for packing; a piece of degree 3 takes about a megabyte. */
const MOST_WAITING = 8;

/**
 * Packs splats in pieces of up to sixteen cells, and drops splats that are not finite.
 *
 * @param row buffer that `fill` writes; its degree may be lower.
 * @param fill writes splat `i` and returns its row index in the file.
 * @throws the signal's reason, and as `SceneWorkers.call`.
 */
export async function packPieces(
  workers: SceneWorkers,
  count: number,
  shDegree: ShDegree,
  row: Float64Array,
  fill: (i: number) => number,
  signal?: AbortSignal,
): Promise<SplatCells[]> {
  const turns = new Turns(signal, SMOOTH_BUSY_MS);
  const pieces: Promise<SplatCells>[] = [];
  const width = widthOf(shDegree);
  for (let start = 0; start < count; start += PIECE_SPLATS) {
    const most = Math.min(PIECE_SPLATS, count - start);
    const rows = new Uint32Array(most);
    const values = new Float32Array(most * width);
    let taken = 0;
    for (let i = start; i < start + most; i++) {
      const number = fill(i);
      if (reasonToDrop(row) !== undefined) continue;
      values.set(row, taken * width);
      rows[taken++] = number;
    }
    const columns: CellColumns = { count: taken, shDegree, rows, values };
    const transfer = [rows.buffer, values.buffer];
    const piece = taken > 0 && workers.call('packCells', columns, { transfer, signal });
    if (piece) {
      // The first failure is reported; later ones must not be unhandled rejections.
      piece.catch(() => {});
      pieces.push(piece);
    }
    await Promise.all([turns.give(), pieces[pieces.length - MOST_WAITING]]);
  }
  return Promise.all(pieces);
}
