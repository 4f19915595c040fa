import type { SplatCells } from '../../data/bricks/leaf-scene.ts';
import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { centerBounds } from '../../data/packing/center-bounds.ts';
import { chunkCountOf, logScalesOf, maxScaleOf } from '../../data/packing/chunks.ts';
import { GEOMETRY_WORDS, packGeometry } from '../../data/packing/geometry.ts';
import { shWordsPerSplat } from '../../data/packing/harmonics.ts';
import { mortonFrame, mortonOrder } from '../../data/packing/morton-order.ts';
import { ROW_SLOT } from '../../data/splats/splat-row.ts';
import type { ShDegree } from '../../data/splats/splat-set.ts';

const { position, logScale, rotation, opacity, colorDc, harmonics: ROW_VALUES } = ROW_SLOT;

/** Splats to be packed together. The arrays may be longer than `count` splats need. */
export interface CellColumns {
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
export function packColumns({ count, shDegree, rows, values, words }: CellColumns): SplatCells {
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
  const placedRows = new Uint32Array(places);
  for (let i = 0; i < count; i++) placedRows[i] = rows[order[i]];
  const { words: packed, chunks } = packGeometry(
    {
      count,
      origin: [0, 0, 0],
      positions: ordered(position, 3),
      logScales: ordered(logScale, 3),
      rotations: ordered(rotation, 4),
      opacityLogits: ordered(opacity, 1),
      colorDc: ordered(colorDc, 3),
      fileIndices: placedRows,
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
  return { cells, geometry, harmonics, rows: placedRows };
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
