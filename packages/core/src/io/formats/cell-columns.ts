import type { SplatCells } from '../../data/bricks/leaf-scene.ts';
import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { chunkCountOf, logScalesOf, maxScaleOf } from '../../data/packing/chunks.ts';
import { GEOMETRY_WORDS, packGeometry } from '../../data/packing/geometry.ts';
import { packCoefficients, shWordsPerSplat } from '../../data/packing/harmonics.ts';
import { mortonOrder } from '../../data/packing/morton-order.ts';
import { ROW_SLOT, reasonToDrop } from '../../data/splats/splat-row.ts';
import { coefficientsPerSplat, type ShDegree } from '../../data/splats/splat-set.ts';
import { Turns } from '../../data/turns.ts';

/** Most splats of a piece. */
const PIECE_SPLATS = LEVEL_CONSTANTS.CELL_CHILDREN * CHUNK_SPLATS;
/** Pieces are packed while frames are drawn. */
const MAX_BUSY_MS = 4;
const { position, logScale, rotation, opacity, colorDc, harmonics: HARMONICS } = ROW_SLOT;

/**
 * Packs splats in pieces of up to sixteen cells, without those that are not finite.
 *
 * @param row that `fill` writes; perhaps of a lower degree.
 * @param fill writes splat `i`, and returns the number of its row.
 * @throws the signal's reason.
 */
export async function packPieces(
  count: number,
  shDegree: ShDegree,
  row: Float64Array,
  fill: (i: number) => number,
  signal?: AbortSignal,
): Promise<SplatCells[]> {
  const turns = new Turns(signal, MAX_BUSY_MS);
  const pieces: SplatCells[] = [];
  for (let start = 0; start < count; start += PIECE_SPLATS) {
    const end = Math.min(start + PIECE_SPLATS, count);
    const columns = new CellColumns(end - start, shDegree);
    for (let i = start; i < end; i++) {
      const number = fill(i);
      if (reasonToDrop(row) === undefined) columns.push(row, number);
    }
    if (columns.count > 0) pieces.push(columns.pack());
    await turns.give();
  }
  return pieces;
}

/** Splats as columns, to be packed together. */
class CellColumns {
  count = 0;
  readonly #shDegree: ShDegree;
  readonly #rows: Uint32Array;
  readonly #values: Float32Array;
  readonly #width: number;

  constructor(most: number, shDegree: ShDegree) {
    this.#shDegree = shDegree;
    this.#width = HARMONICS + coefficientsPerSplat(shDegree);
    this.#rows = new Uint32Array(most);
    this.#values = new Float32Array(most * this.#width);
  }

  /** Adds a row, perhaps of a lower degree. */
  push(row: Float64Array, number: number): void {
    this.#values.set(row, this.count * this.#width);
    this.#rows[this.count++] = number;
  }

  /** Packs all that are there, at least one, in Morton order. */
  pack(): SplatCells {
    const { count } = this;
    const unordered = this.#column(position, 3);
    const order = mortonOrder(unordered, count);
    const ordered = (slot: number, width: number) => this.#column(slot, width, order);
    const places = CHUNK_SPLATS * chunkCountOf(count);
    const rows = new Uint32Array(places);
    for (let i = 0; i < count; i++) rows[i] = this.#rows[order[i]];
    const { words, chunks } = packGeometry(
      {
        count,
        origin: [0, 0, 0],
        positions: ordered(position, 3),
        logScales: ordered(logScale, 3),
        rotations: ordered(rotation, 4),
        opacityLogits: ordered(opacity, 1),
        colorDc: ordered(colorDc, 3),
        fileIndices: rows,
        dropped: {},
      },
      'packed',
    );
    const geometry = new Uint32Array(places * GEOMETRY_WORDS.packed);
    geometry.set(words);
    const degree = this.#shDegree;
    const shWords = degree > 0 ? shWordsPerSplat(degree, 'u8') : 0;
    const harmonics = new Uint32Array(places * shWords);
    for (let i = 0; i < count && degree > 0; i++) {
      const at = order[i] * this.#width + HARMONICS;
      const values = this.#values.subarray(at, at + this.#width - HARMONICS);
      packCoefficients(degree, 'u8', values, harmonics, i * shWords);
    }
    const cells = Array.from({ length: chunkCountOf(count) }, (_, chunk) => cellOf(chunks, chunk, count));
    return { cells, geometry, harmonics, rows };
  }

  #column(slot: number, width: number, order?: Uint32Array): Float32Array {
    const column = new Float32Array(this.count * width);
    for (let i = 0; i < this.count; i++) {
      const from = (order ? order[i] : i) * this.#width + slot;
      for (let k = 0; k < width; k++) column[i * width + k] = this.#values[from + k];
    }
    return column;
  }
}

/** The cell of a chunk of splats. */
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
