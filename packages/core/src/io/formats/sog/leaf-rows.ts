import {
  type LeafFile,
  type LeafLevel,
  NO_ROW,
  type SceneLeaf,
  type SplatCells,
} from '../../../data/bricks/leaf-scene.ts';
import { SplatFileError } from '../../../data/errors.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import type { Bounds } from '../../../data/packing/packed-cloud.ts';
import { paletteValues, type RowLayout } from '../../../data/packing/row-layout.ts';
import { ROW_SLOT, reasonToDrop } from '../../../data/splats/splat-row.ts';
import { coefficientsPerSplat, type ShDegree } from '../../../data/splats/splat-set.ts';
import type { SceneWorkers } from '../../loading/scene-workers.ts';
import { packPieces } from '../pack-pieces.ts';
import type { RowSink } from '../row-sink.ts';

/**
 * Tolerance for centres outside of their leaf's bounds, relative to 1 + the distance from the
 * origin. Files round logarithms of coordinates to 16 bits.
 */
const POSITION_ROUNDING = 1e-3;
const { position, harmonics: HARMONICS } = ROW_SLOT;

/** Facts about a file, according to the scene's metadata. */
export interface PromisedRows {
  /** Path of the file, for messages. */
  readonly file: string;
  readonly count: number;
  /** Highest degree of harmonics for which there is room. */
  readonly shDegree: ShDegree;
  /** Origin of the scene, to which leaf bounds and cell positions are relative. */
  readonly origin: Vec3;
}

/** A level of a leaf: consecutive splats of a file. */
export interface LeafSplats extends LeafLevel {
  readonly offset: number;
  /** Row of the first splat in a load of the finest levels; null for coarser levels. */
  readonly firstRow: number | null;
}

/** Stores the rows of a file of a streamed scene, to pack its leaves. */
export class LeafRows implements RowSink, LeafFile {
  readonly mayDetach = true;
  readonly #promised: PromisedRows;
  readonly #workers: SceneWorkers;
  #layout: RowLayout | null = null;
  #palette = new Float32Array(0);
  #paletteLength = 0;
  /** Pieces of `pieceRows` rows; the last may have fewer. */
  readonly #pieces: Float32Array[] = [];

  /** @param workers workers that pack the leaves. */
  constructor(promised: PromisedRows, workers: SceneWorkers) {
    this.#promised = promised;
    this.#workers = workers;
  }

  /** @throws SplatFileError 'damaged' if the file contradicts the scene's metadata. */
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

  async pieces({ bounds }: SceneLeaf, level: LeafSplats, signal?: AbortSignal): Promise<SplatCells[]> {
    const { offset, count, firstRow } = level;
    const { shDegree, origin: fileOrigin = [0, 0, 0] } = this.#layout!;
    const { origin } = this.#promised;
    const row = new Float64Array(HARMONICS + coefficientsPerSplat(shDegree));
    const fill = (i: number) => {
      this.#fill(row, offset + i);
      for (let axis = 0; axis < 3; axis++) row[position + axis] += fileOrigin[axis] - origin[axis];
      if (bounds && reasonToDrop(row) === undefined && !isWithin(row, bounds, origin)) {
        const message = 'a splat lies outside of its part of the scene. Export the scene again.';
        throw new SplatFileError('damaged', this.#promised.file, message, { row: offset + i });
      }
      return firstRow === null ? NO_ROW : firstRow + i;
    };
    return packPieces(this.#workers, count, this.#promised.shDegree, row, fill, signal);
  }

  /** Writes row `i` into `row`, with values as trained. */
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

/** Whether the centre of a row lies within bounds, with a tolerance. Both are relative to `origin`. */
function isWithin(row: Float64Array, { min, max }: Bounds, origin: Vec3): boolean {
  for (let axis = 0; axis < 3; axis++) {
    const value = row[position + axis];
    const slack = POSITION_ROUNDING * (1 + Math.abs(value + origin[axis]));
    if (value < min[axis] - slack || value > max[axis] + slack) return false;
  }
  return true;
}
