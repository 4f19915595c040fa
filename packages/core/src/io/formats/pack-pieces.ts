import type { SplatCells } from '../../data/bricks/leaf-scene.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { shWordsPerSplat } from '../../data/packing/harmonics.ts';
import { ROW_SLOT, reasonToDrop } from '../../data/splats/splat-row.ts';
import type { ShDegree } from '../../data/splats/splat-set.ts';
import type { Turns } from '../../data/turns.ts';
import { packColumns } from './pack-columns.ts';

/** Most splats per piece. */
const PIECE_SPLATS = LEVEL_CONSTANTS.CELL_CHILDREN * CHUNK_SPLATS;
const ROW_VALUES = ROW_SLOT.harmonics;

/** Result of a `FillSplat` that leaves out its splat. */
export const LEFT_OUT = -1;

/**
 * Writes splat `i` into the buffer `row`, and its packed harmonics into `words` from `wordOffset` on,
 * which are 0 before.
 *
 * @returns the splat's row index in the file, or `LEFT_OUT`.
 */
export type FillSplat = (i: number, words: Uint32Array, wordOffset: number) => number;

/**
 * Packs splats in pieces of up to sixteen cells, and drops splats that are not finite.
 *
 * @param row buffer that `fill` writes: values as trained, by `ROW_SLOT`. Harmonics in it are checked
 *   only.
 * @throws the reason of the turns' signal.
 */
export async function packPieces(
  count: number,
  shDegree: ShDegree,
  row: Float32Array | Float64Array,
  fill: FillSplat,
  turns: Turns,
): Promise<SplatCells[]> {
  const pieces: SplatCells[] = [];
  const shWords = shWordsPerSplat(shDegree, 'u8');
  const most = Math.min(PIECE_SPLATS, count);
  const values = new Float32Array(most * ROW_VALUES);
  const words = new Uint32Array(most * shWords);
  const rows = new Uint32Array(most);
  for (let start = 0; start < count; start += PIECE_SPLATS) {
    const end = Math.min(count, start + PIECE_SPLATS);
    words.fill(0);
    let taken = 0;
    for (let i = start; i < end; i++) {
      const number = fill(i, words, taken * shWords);
      if (number === LEFT_OUT || reasonToDrop(row) !== undefined) {
        words.fill(0, taken * shWords, (taken + 1) * shWords);
        continue;
      }
      for (let slot = 0; slot < ROW_VALUES; slot++) values[taken * ROW_VALUES + slot] = row[slot];
      rows[taken++] = number;
    }
    if (taken > 0) pieces.push(packColumns({ count: taken, shDegree, rows, values, words }));
    await turns.give();
  }
  return pieces;
}
