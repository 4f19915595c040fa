import { SplatFileError } from '../../../data/errors.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { ShReachMeter } from '../../../data/packing/band-reach.ts';
import { centerBounds } from '../../../data/packing/center-bounds.ts';
import { type PackedHarmonics, packCoefficients, shWordsPerSplat } from '../../../data/packing/harmonics.ts';
import { chooseOrigin } from '../../../data/packing/origin.ts';
import { PositionSample } from '../../../data/packing/position-sample.ts';
import type { OwnShPrecision } from '../../../data/packing/precision.ts';
import { COLUMNS, mapColumns, OPTIONAL_COLUMNS, type OptionalColumn } from '../../../data/splats/columns.ts';
import { ROW_SLOT, reasonToDrop } from '../../../data/splats/splat-row.ts';
import {
  coefficientsPerSplat,
  type DropCounts,
  type FileFacts,
  type ShDegree,
  type SplatSet,
} from '../../../data/splats/splat-set.ts';
import type { OnPiece } from '../read-format.ts';
import { CoarsePlaces } from './coarse-places.ts';
import { emptyError } from './splat-counts.ts';

const FIRST_CAPACITY = 4096;
/** Least splats per piece: a few megabytes. */
const PIECE_SPLATS = 1 << 14;

interface Columns {
  positions: Float32Array | Float64Array;
  logScales: Float32Array;
  rotations: Float32Array;
  opacityLogits: Float32Array;
  colorDc: Float32Array;
  shWords: Uint32Array;
  fileIndices: Uint32Array;
  motion?: Float32Array;
}

export interface SplatSetBuilderOptions {
  /** File name for messages. */
  readonly file: string;
  readonly shDegree: ShDegree;
  readonly shPrecision: OwnShPrecision;
  /** Whether positions exceed float32 precision; they stay float64 until the origin is known. */
  readonly widePositions: boolean;
  /** Point that pushed positions are relative to. Default: the set's origin is computed from them. */
  readonly origin?: Vec3;
  /** Most rows that will be pushed. */
  readonly promisedCount: number;
  /** Whether all rows are present already, so that memory for them can be allocated at once. */
  readonly isLocal: boolean;
  /** See `SplatColumns`. */
  readonly isAntialiased?: boolean;
  readonly fileFacts?: FileFacts;
  /** Names of the optional columns whose values follow the harmonics of each row. Default: none. */
  readonly optional?: readonly OptionalColumn['name'][];
  /** See `SplatFormatOptions`. */
  readonly onPiece?: OnPiece;
  /**
   * Changes the splat's values in `row` before each push. One extra value, which may belong into
   * them, follows them.
   */
  readonly adjust?: (row: Float64Array) => void;
}

/**
 * Collects splats row by row: fill `row`, then call `push`. Harmonics are packed immediately. Rows
 * that are not finite in float32 are dropped and counted. Calling `handOn` between rows keeps
 * memory bounded.
 */
export class SplatSetBuilder {
  /** The next splat's values, by `ROW_SLOT`. */
  readonly row: Float64Array;
  readonly #options: SplatSetBuilderOptions;
  /** `row` without optional columns and the extra value for `adjust`. */
  readonly #splat: Float64Array;
  readonly #shRow: Float64Array;
  readonly #optional: readonly OptionalColumn[];
  readonly #wordsPerSplat: number;
  readonly #reach: ShReachMeter;
  readonly #coarsePlaces = new CoarsePlaces();
  #dropped: DropCounts = {};
  #columns: Columns;
  #capacity = 0;
  #count = 0;
  #handedOn = 0;

  constructor(options: SplatSetBuilderOptions) {
    this.#options = options;
    const length = ROW_SLOT.harmonics + coefficientsPerSplat(options.shDegree);
    this.#optional = OPTIONAL_COLUMNS.filter(({ name }) => options.optional?.includes(name));
    const end = this.#optional.reduce((sum, { width }) => sum + width, length);
    this.row = new Float64Array(options.adjust ? end + 1 : end);
    this.#splat = this.row.subarray(0, length);
    this.#shRow = this.row.subarray(ROW_SLOT.harmonics, length);
    this.#wordsPerSplat = shWordsPerSplat(options.shDegree, options.shPrecision);
    this.#reach = new ShReachMeter(options.shDegree);
    this.#columns = {
      positions: new (options.widePositions ? Float64Array : Float32Array)(0),
      logScales: new Float32Array(0),
      rotations: new Float32Array(0),
      opacityLogits: new Float32Array(0),
      colorDc: new Float32Array(0),
      shWords: new Uint32Array(0),
      fileIndices: new Uint32Array(0),
    };
    for (const { name } of this.#optional) this.#columns[name] = new Float32Array(0);
    const { promisedCount, isLocal, onPiece } = options;
    const mostAtFirst = onPiece ? 2 * PIECE_SPLATS : isLocal ? promisedCount : FIRST_CAPACITY;
    this.#setCapacity(Math.min(mostAtFirst, promisedCount));
  }

  /** Number of splats kept so far. */
  get count(): number {
    return this.#handedOn + this.#count;
  }

  /** Adds the splat in `row`; `fileIndex` is its row in the file. */
  push(fileIndex: number): void {
    this.#options.adjust?.(this.row);
    const row = this.#splat;
    let reason = reasonToDrop(row);
    let at = row.length;
    for (const { width, reasonToDrop: reasonOf } of this.#optional) {
      reason ??= reasonOf(this.row.subarray(at, at + width));
      at += width;
    }
    if (reason !== undefined) {
      this.#dropped[reason] = (this.#dropped[reason] ?? 0) + 1;
      return;
    }
    if (this.#count === this.#capacity)
      this.#setCapacity(Math.min(2 * this.#capacity, this.#options.promisedCount));
    const index = this.#count++;
    const { positions, logScales, rotations, opacityLogits, colorDc, shWords, fileIndices } = this.#columns;
    for (let i = 0; i < 3; i++) {
      positions[3 * index + i] = row[ROW_SLOT.position + i];
      logScales[3 * index + i] = row[ROW_SLOT.logScale + i];
      colorDc[3 * index + i] = row[ROW_SLOT.colorDc + i];
    }
    for (let i = 0; i < 4; i++) rotations[4 * index + i] = row[ROW_SLOT.rotation + i];
    opacityLogits[index] = row[ROW_SLOT.opacity];
    fileIndices[index] = fileIndex;
    at = row.length;
    for (const { name, width } of this.#optional) {
      this.#columns[name]!.set(this.row.subarray(at, at + width), index * width);
      at += width;
    }
    packCoefficients(
      this.#options.shDegree,
      this.#options.shPrecision,
      this.#shRow,
      shWords,
      index * this.#wordsPerSplat,
    );
    // Measured before rounding, so the bands that are stored do not depend on the precision.
    this.#reach.include(this.#shRow, 0);
  }

  /** Passes the splats so far to `onPiece`, if present, once a piece is full. Their memory is reused. */
  async handOn(): Promise<void> {
    const { onPiece } = this.#options;
    if (!onPiece || this.#count < PIECE_SPLATS) return;
    const count = this.#count;
    const piece = this.#setOf({
      ...mapColumns(this.#columns, (column, width) => column.subarray(0, width * count) as typeof column),
      shWords: this.#columns.shWords.subarray(0, this.#wordsPerSplat * count),
    });
    await onPiece(piece);
    this.#handedOn += count;
    this.#count = 0;
    this.#dropped = {};
  }

  /** The finished set, or its last piece. Throws `SplatFileError` 'empty' if no row was kept. */
  finish(): SplatSet<PackedHarmonics> {
    if (this.count === 0) throw emptyError(this.#options.file, this.#dropped);
    this.#setCapacity(this.#count);
    return this.#setOf(this.#columns);
  }

  #setOf({ positions, shWords, ...columns }: Columns): SplatSet<PackedHarmonics> {
    const { isAntialiased, fileFacts, origin, widePositions } = this.#options;
    const placed = { ...columns, count: this.#count, ...this.#placed(positions) };
    // Positions relative to a given origin were rounded to float32 before they were pushed.
    if (origin || widePositions)
      this.#coarsePlaces.add(
        placed,
        (at) => origin !== undefined || positions[at] - placed.origin[at % 3] !== placed.positions[at],
      );
    const { note } = this.#coarsePlaces;
    const notes = note === undefined ? undefined : [...(fileFacts?.notes ?? []), note];
    return {
      ...placed,
      harmonics: {
        degree: this.#options.shDegree,
        precision: this.#options.shPrecision,
        wordsPerSplat: this.#wordsPerSplat,
        words: shWords,
        bandReach: this.#reach.reaches(),
      },
      dropped: this.#dropped,
      ...(isAntialiased !== undefined && { isAntialiased }),
      ...(fileFacts && { fileFacts: { ...fileFacts, ...(notes && { notes }) } }),
    };
  }

  #placed(positions: Columns['positions']): Pick<SplatSet, 'origin' | 'positions'> {
    const { origin: given, widePositions } = this.#options;
    if (given) return { origin: given, positions: positionsFrom(positions, [0, 0, 0]) };
    const bounds = centerBounds(positions, this.#count);
    const sample = new PositionSample();
    sample.addAll(positions, this.#count);
    const origin = chooseOrigin(sample.axes, bounds, widePositions);
    return { origin, positions: positionsFrom(positions, origin) };
  }

  #setCapacity(capacity: number): void {
    if (capacity === this.#capacity) return;
    const columns = this.#columns;
    try {
      // One after another, so that only one column is duplicated at a time.
      for (const { name, width } of COLUMNS)
        if (columns[name]) Object.assign(columns, { [name]: resized(columns[name], width * capacity) });
      columns.shWords = resized(columns.shWords, this.#wordsPerSplat * capacity);
    } catch (cause) {
      if (!(cause instanceof RangeError)) throw cause;
      const { file, shPrecision } = this.#options;
      const advice =
        shPrecision === 'u8'
          ? 'Read a smaller scene'
          : `Read it with shPrecision u8 instead of ${shPrecision}`;
      throw new SplatFileError(
        'too-large',
        file,
        `no memory for ${capacity} splats. ${advice}.`,
        {},
        { cause },
      );
    }
    this.#capacity = capacity;
  }
}

function resized<T extends Float32Array | Float64Array | Uint32Array>(column: T, length: number): T {
  const result = new (column.constructor as new (length: number) => T)(length);
  result.set(column.subarray(0, length));
  return result;
}

function positionsFrom(
  positions: Float32Array | Float64Array,
  origin: readonly [number, number, number],
): Float32Array {
  const unmoved = origin.every((value) => value === 0);
  if (unmoved) return positions instanceof Float32Array ? positions : Float32Array.from(positions);
  const relative = positions instanceof Float32Array ? positions : new Float32Array(positions.length);
  for (let i = 0; i < positions.length; i++) relative[i] = positions[i] - origin[i % 3];
  return relative;
}
