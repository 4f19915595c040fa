import type { LeafFile, LeafLevel, SceneLeaf, SplatCells } from '../../../data/bricks/leaf-scene.ts';
import { NO_ROW } from '../../../data/bricks/leaf-scene.ts';
import { SplatFileError } from '../../../data/errors.ts';
import { CHUNK_WORDS } from '../../../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../../data/layout/level-structs.ts';
import { chunkCountOf, logScalesOf, maxScaleOf } from '../../../data/packing/chunks.ts';
import { GEOMETRY_WORDS, packGeometry } from '../../../data/packing/geometry.ts';
import { packCoefficients, shWordsPerSplat } from '../../../data/packing/harmonics.ts';
import { mortonOrder } from '../../../data/packing/morton-order.ts';
import { paletteValues, type RowLayout } from '../../../data/packing/row-layout.ts';
import { ROW_SLOT, reasonToDrop } from '../../../data/splats/splat-row.ts';
import { coefficientsPerSplat, type ShDegree } from '../../../data/splats/splat-set.ts';
import { Turns } from '../../../data/turns.ts';
import type { RowSink } from '../row-sink.ts';

/** Most splats of a piece. */
const PIECE_SPLATS = LEVEL_CONSTANTS.CELL_CHILDREN * CHUNK_SPLATS;
/** Pieces are packed while frames are drawn. */
const MAX_BUSY_MS = 4;
/**
 * How far a centre may lie outside of its leaf, per unit of its distance from the origin and 1:
 * files round logarithms of coordinates to 16 bits.
 */
const POSITION_ROUNDING = 1e-3;
const { position, logScale, rotation, opacity, colorDc, harmonics: HARMONICS } = ROW_SLOT;

/** What a scene says of one of its files. */
export interface PromisedRows {
  /** Its path, for messages. */
  readonly file: string;
  readonly count: number;
  /** Most degrees of harmonics that it may have: those that there is room for. */
  readonly shDegree: ShDegree;
}

/** Keeps the rows of a file of a streamed scene, to make cells of the leaves in it. */
export class LeafRows implements RowSink, LeafFile {
  readonly mayDetach = true;
  readonly #promised: PromisedRows;
  #layout: RowLayout | null = null;
  #palette = new Float32Array(0);
  #paletteLength = 0;
  /** All but the last have `pieceRows` rows. */
  readonly #pieces: Float32Array[] = [];

  constructor(promised: PromisedRows) {
    this.#promised = promised;
  }

  /** @throws SplatFileError 'damaged' for a file that is not as the scene says. */
  async begin(layout: RowLayout): Promise<void> {
    const { file, count, shDegree } = this.#promised;
    const damaged = (message: string) =>
      new SplatFileError('damaged', file, `${message} Export the scene again.`);
    if (layout.count !== count)
      throw damaged(`it has ${layout.count} splats, where the scene says ${count}.`);
    if (layout.shDegree > shDegree)
      throw damaged(`its harmonics have degree ${layout.shDegree}, those of the finest level ${shDegree}.`);
    this.#layout = layout;
    this.#palette = new Float32Array(paletteValues(layout));
  }

  async memory(): Promise<Uint8Array<ArrayBuffer>> {
    const { count, pieceRows, strideBytes } = this.#layout!;
    return new Uint8Array(Math.min(count, pieceRows) * strideBytes);
  }

  take(rowCount: number, { buffer, byteOffset }: Uint8Array<ArrayBuffer>): void {
    if (this.#paletteLength < this.#palette.length) {
      this.#palette.set(new Float32Array(buffer, byteOffset, rowCount), this.#paletteLength);
      this.#paletteLength += rowCount;
      return;
    }
    this.#pieces.push(new Float32Array(buffer, byteOffset, (rowCount * this.#layout!.strideBytes) / 4));
  }

  get bytes(): number {
    return this.#pieces.reduce((sum, { byteLength }) => sum + byteLength, this.#palette.byteLength);
  }

  async pieces({ bounds }: SceneLeaf, level: LeafLevel, signal?: AbortSignal): Promise<SplatCells[]> {
    const { offset, count, firstRow } = level;
    const turns = new Turns(signal, MAX_BUSY_MS);
    const pieces: SplatCells[] = [];
    const row = new Float64Array(HARMONICS + coefficientsPerSplat(this.#layout!.shDegree));
    for (let start = offset; start < offset + count; start += PIECE_SPLATS) {
      const columns = new Columns(PIECE_SPLATS, this.#promised.shDegree);
      for (let i = start; i < Math.min(start + PIECE_SPLATS, offset + count); i++) {
        this.#fill(row, i);
        if (reasonToDrop(row) !== undefined) continue;
        if (bounds && !isWithin(row, bounds.min, bounds.max)) {
          const message = 'a splat lies outside of its part of the scene. Export the scene again.';
          throw new SplatFileError('damaged', this.#promised.file, message, { row: i });
        }
        columns.push(row, firstRow === null ? NO_ROW : firstRow + i - offset);
      }
      if (columns.count > 0) pieces.push(columns.pack());
      await turns.give();
    }
    return pieces;
  }

  /** Writes row `i` into `row`, as trained. */
  #fill(row: Float64Array, i: number): void {
    const { pieceRows, strideBytes, offsets, palette } = this.#layout!;
    const values = this.#pieces[Math.floor(i / pieceRows)];
    const at = ((i % pieceRows) * strideBytes) / 4;
    for (let slot = 0; slot < HARMONICS; slot++) row[slot] = values[at + offsets[slot] / 4];
    const first = at + offsets[HARMONICS] / 4;
    for (let k = 0; HARMONICS + k < row.length; k++)
      row[HARMONICS + k] = palette
        ? this.#palette[values[first] * palette.entryValues + k]
        : values[at + offsets[HARMONICS + k] / 4];
  }
}

/** Splats as columns, to be packed together. */
class Columns {
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

/** Whether the centre of a row lies within bounds, but for rounding. */
function isWithin(row: Float64Array, min: readonly number[], max: readonly number[]): boolean {
  for (let axis = 0; axis < 3; axis++) {
    const value = row[position + axis];
    const slack = POSITION_ROUNDING * (1 + Math.abs(value));
    if (value < min[axis] - slack || value > max[axis] + slack) return false;
  }
  return true;
}
