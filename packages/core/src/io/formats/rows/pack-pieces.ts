import type { SplatCells } from '../../../data/bricks/leaf-scene.ts';
import { CHUNK_WORDS } from '../../../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../../data/layout/level-structs.ts';
import { centerBounds } from '../../../data/packing/center-bounds.ts';
import { chunkCountOf, logScalesOf, maxScaleOf } from '../../../data/packing/chunks.ts';
import { GEOMETRY_WORDS, packGeometry } from '../../../data/packing/geometry.ts';
import { shWordsPerSplat } from '../../../data/packing/harmonics.ts';
import { mortonFrame, mortonOrder } from '../../../data/packing/morton-order.ts';
import { ROW_SLOT, reasonToDrop } from '../../../data/splats/splat-row.ts';
import type { ShDegree } from '../../../data/splats/splat-set.ts';
import type { Turns } from '../../../data/turns.ts';

/** Most splats per piece. */
const PIECE_SPLATS = LEVEL_CONSTANTS.CELL_CHILDREN * CHUNK_SPLATS;
const { position, logScale, rotation, opacity, colorDc, harmonics: ROW_VALUES } = ROW_SLOT;

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

/** Splats to be packed together. The arrays may be longer than `count` splats need. */
interface CellColumns {
  readonly count: number;
  readonly shDegree: ShDegree;
  /** Row indices in the file. */
  readonly rows: Uint32Array;
  /** Values of each splat as trained, by `ROW_SLOT`, without harmonics. */
  readonly values: Float32Array;
  /** Harmonics of each splat as the GPU reads them, in precision u8. */
  readonly words: Uint32Array;
}

/** Packs one or more splats in Morton order. */
function packColumns({ count, shDegree, rows, values, words }: CellColumns): SplatCells {
  const column = (slot: number, slots: number, order?: Uint32Array) => {
    const found = new Float32Array(count * slots);
    for (let i = 0; i < count; i++) {
      const from = (order ? order[i] : i) * ROW_VALUES + slot;
      for (let k = 0; k < slots; k++) found[i * slots + k] = values[from + k];
    }
    return found;
  };
  const positions = column(position, 3);
  const { min, max } = centerBounds(positions, count);
  // Pieces are parts of ordered files: a frame that minds outliers would take a third of the time.
  const order = mortonOrder(positions, count, mortonFrame(min, max));
  const ordered = (slot: number, slots: number) => column(slot, slots, order);
  const places = CHUNK_SPLATS * chunkCountOf(count);
  const fileIndices = new Uint32Array(places);
  for (let i = 0; i < count; i++) fileIndices[i] = rows[order[i]];
  const { words: packed, chunks } = packGeometry(
    {
      count,
      origin: [0, 0, 0],
      positions: ordered(position, 3),
      logScales: ordered(logScale, 3),
      rotations: ordered(rotation, 4),
      opacityLogits: ordered(opacity, 1),
      colorDc: ordered(colorDc, 3),
      fileIndices,
      dropped: {},
    },
    'packed',
  );
  const geometry = new Uint32Array(places * GEOMETRY_WORDS.packed);
  geometry.set(packed);
  const shWords = shWordsPerSplat(shDegree, 'u8');
  const harmonics = new Uint32Array(places * shWords);
  for (let i = 0; i < count; i++)
    for (let k = 0; k < shWords; k++) harmonics[i * shWords + k] = words[order[i] * shWords + k];
  const cells = Array.from({ length: chunkCountOf(count) }, (_, chunk) => cellOf(chunks, chunk, count));
  return { cells, geometry, harmonics, fileIndices };
}
/** Bounds and other facts of the cell of a chunk. */
function cellOf(chunks: Float32Array, chunk: number, count: number): SplatCells['cells'][number] {
  const at = chunk * CHUNK_WORDS.count;
  const vector = (word: number) => [chunks[at + word], chunks[at + word + 1], chunks[at + word + 2]] as const;
  const { min, step } = logScalesOf(chunks, chunk);
  return {
    bounds: { min: vector(CHUNK_WORDS.minPosition), max: vector(CHUNK_WORDS.maxPosition) },
    largestScale: maxScaleOf(chunks, chunk),
    leafCount: Math.min(CHUNK_SPLATS, count - CHUNK_SPLATS * chunk),
    logScales: [min, step],
    child: null,
    childErrors: [],
    childRoots: [],
  };
}
