import type { Vec3 } from '../../data/math/mat4.ts';
import type { PackedHarmonics } from '../../data/packing/harmonics.ts';
import { type RowLayout, type RowPalette, rowsWithin } from '../../data/packing/row-layout.ts';
import { ROW_SLOT, reasonToDrop } from '../../data/splats/splat-row.ts';
import {
  coefficientsPerSplat,
  type FileFacts,
  type ShDegree,
  type SplatSet,
} from '../../data/splats/splat-set.ts';
import { checkCount } from './check-count.ts';
import { CoarsePlaces } from './coarse-places.ts';
import { ReadProgress } from './progress.ts';
import type { SplatFormatOptions, SplatInput } from './read-format.ts';
import { type Passed, type RowSink, type RowsTo, takesCount } from './row-sink.ts';
import { SplatSetBuilder } from './splat-set-builder.ts';

/** Rows between two yields to the event loop. */
const ROWS_AT_ONCE = 4096;

/** Harmonics shared by the splats of a file, for sinks that accept a palette. */
export interface DecodedPalette extends RowPalette {
  /** The coefficients of all entries, in the layout of rows. Call it after `arrive` has resolved. */
  values(): Float32Array;
  /** As `DecodedRows.decode`, but writes a palette index in place of the harmonics. */
  decode(rows: Float32Array, rowCount: number): void;
}

/** Rows whose harmonics stay bytes of the file, by `shOfByte`, for sinks. */
export interface DecodedByteHarmonics {
  /** Byte offset of each coefficient, relative to the first byte behind a row's float32 values. */
  readonly offsets: readonly number[];
  /** Bytes behind the float32 values of a row; a multiple of 4. */
  readonly strideBytes: number;
  /** As `DecodedRows.decode`, but writes bytes in place of float32 harmonics. */
  decode(rows: Float32Array, rowCount: number): void;
}

/** Rows of a file, to be decoded in order. Their bytes are present or certain to arrive. */
export interface DecodedRows {
  /** Number of rows. Memory for all rows is allocated at once. */
  readonly count: number;
  readonly shDegree: ShDegree;
  /**
   * Scene-space point, float64, that positions in rows are relative to: the cloud's origin. Absent
   * if positions are float32 coordinates of the file; the origin is then computed from them.
   */
  readonly origin?: Vec3;
  /**
   * Whether training had an antialias filter, according to the file; undefined if the file does not
   * state it.
   */
  readonly isAntialiased?: boolean;
  readonly fileFacts?: FileFacts;
  /** Waits for the next `rowCount` rows; absent if all are present. Rejects as `ReadFormat`. */
  arrive?(rowCount: number): Promise<void>;
  /**
   * Writes the next `rowCount` rows into `rows`, which must be large enough. A row has
   * `rowLength(shDegree)` values, by `ROW_SLOT`, as trained: log scales, logits, rotation w x y z.
   */
  decode(rows: Float32Array, rowCount: number): void;
  /** Absent if rows have separate harmonics, or if a palette would not be smaller. */
  readonly palette?: DecodedPalette;
  /** Absent unless harmonics are bytes in the file, and take less memory as such. */
  readonly byteHarmonics?: DecodedByteHarmonics;
}

/** Number of values per row. */
export function rowLength(shDegree: ShDegree): number {
  return ROW_SLOT.harmonics + coefficientsPerSplat(shDegree);
}

/**
 * Delivers decoded rows as `ReadFormat` specifies: to `rowsTo` if it accepts the row count, else as
 * a set.
 *
 * @param progress progress so far; undefined if the scene has a single file.
 */
export async function deliverRows(
  rows: DecodedRows,
  input: SplatInput,
  options: SplatFormatOptions,
  rowsTo: RowsTo | undefined,
  progress = new ReadProgress(input, options.onProgress),
): Promise<SplatSet<PackedHarmonics> | Passed> {
  const { count } = rows;
  checkCount(count, input.name, options.maxSplats);
  const isPassed = rowsTo && takesCount(rowsTo.files, count);
  if (isPassed) await passRows(rows, input, rowsTo, progress);
  const result = isPassed ? 'passed' : await collectRows(rows, input, options, progress);
  progress.finish(count);
  return result;
}

async function passRows(
  { count, shDegree, origin, palette, byteHarmonics, isAntialiased, fileFacts, arrive, ...rows }: DecodedRows,
  { reader }: SplatInput,
  { sink, files }: RowsTo,
  progress: ReadProgress,
): Promise<void> {
  const floatCount = floatsPerRow(shDegree, palette, byteHarmonics);
  const floatBytes = 4 * floatCount;
  const { decode } = palette ?? byteHarmonics ?? rows;
  const strideBytes = floatBytes + (byteHarmonics?.strideBytes ?? 0);
  const length = strideBytes / 4;
  const pieceRows = rowsWithin(files.pieceBytes, strideBytes);
  const coarsePlaces = origin && new CoarsePlaces();
  const offsets = Array.from({ length: floatCount }, (_, slot) => 4 * slot);
  for (const offset of byteHarmonics?.offsets ?? []) offsets.push(floatBytes + offset);
  const layout: RowLayout = {
    count,
    strideBytes,
    pieceRows,
    offsets,
    isBigEndian: false,
    shDegree,
    origin,
    ...(palette && { palette: { entryCount: palette.entryCount, entryValues: palette.entryValues } }),
    ...(byteHarmonics && { hasByteHarmonics: true }),
    isAntialiased,
    fileFacts,
  };
  await sink.begin(layout);
  if (palette) {
    await arrive?.(0);
    await passValues(palette.values(), Math.min(count, pieceRows) * length, sink);
  }
  for (let row = 0; row < count; row += pieceRows) {
    const rowCount = Math.min(pieceRows, count - row);
    const memory = await sink.memory();
    const values = new Float32Array(memory.buffer, memory.byteOffset, rowCount * length);
    for (let done = 0; done < rowCount; done += ROWS_AT_ONCE) {
      const nextRows = Math.min(ROWS_AT_ONCE, rowCount - done);
      await arrive?.(nextRows);
      decode(values.subarray(done * length), nextRows);
      progress.report(row + done);
      await reader.pause();
    }
    if (coarsePlaces) addRows(coarsePlaces, values, length, floatCount);
    sink.take(rowCount, memory);
  }
  if (coarsePlaces?.note !== undefined) sink.note?.(coarsePlaces.note);
  // Releases the bytes of the last rows, so that progress counts them.
  await arrive?.(0);
}

function floatsPerRow(
  shDegree: ShDegree,
  palette: DecodedPalette | undefined,
  byteHarmonics: DecodedByteHarmonics | undefined,
): number {
  if (palette) return ROW_SLOT.harmonics + 1;
  return byteHarmonics ? ROW_SLOT.harmonics : rowLength(shDegree);
}

/**
 * Moves rows to an origin and drops invalid rows.
 *
 * @param length words per row.
 * @param floatCount float32 values at the beginning of a row. Harmonics of bytes are always finite.
 */
function addRows(coarsePlaces: CoarsePlaces, rows: Float32Array, length: number, floatCount: number): void {
  const positions = new Float32Array((3 * rows.length) / length);
  const logScales = new Float32Array(positions.length);
  const row = new Float64Array(floatCount);
  let count = 0;
  for (let at = 0; at < rows.length; at += length) {
    // A view of each row would take longer than its values.
    for (let i = 0; i < floatCount; i++) row[i] = rows[at + i];
    if (reasonToDrop(row) !== undefined) continue;
    for (let axis = 0; axis < 3; axis++) {
      positions[3 * count + axis] = row[ROW_SLOT.position + axis];
      logScales[3 * count + axis] = row[ROW_SLOT.logScale + axis];
    }
    count++;
  }
  coarsePlaces.add({ count, positions, logScales }, () => true);
}

async function passValues(values: Float32Array, atOnce: number, sink: RowSink): Promise<void> {
  for (let at = 0; at < values.length; at += atOnce) {
    const part = values.subarray(at, at + atOnce);
    const memory = await sink.memory();
    new Float32Array(memory.buffer, memory.byteOffset, part.length).set(part);
    sink.take(part.length, memory);
  }
}

async function collectRows(
  { count, shDegree, origin, isAntialiased, fileFacts, arrive, decode }: DecodedRows,
  { name, reader }: SplatInput,
  { shPrecision, onPiece }: SplatFormatOptions,
  progress: ReadProgress,
): Promise<SplatSet<PackedHarmonics>> {
  const length = rowLength(shDegree);
  const builder = new SplatSetBuilder({
    file: name,
    shDegree,
    shPrecision,
    widePositions: false,
    origin,
    promisedCount: count,
    isHeld: true,
    isAntialiased,
    fileFacts,
    onPiece,
  });
  const values = new Float32Array(Math.min(count, ROWS_AT_ONCE) * length);
  for (let row = 0; row < count; row += ROWS_AT_ONCE) {
    const rowCount = Math.min(ROWS_AT_ONCE, count - row);
    await arrive?.(rowCount);
    decode(values, rowCount);
    for (let i = 0; i < rowCount; i++) {
      builder.row.set(values.subarray(i * length, (i + 1) * length));
      builder.push(row + i);
    }
    progress.report(row);
    await builder.handOn();
    await reader.pause();
  }
  return builder.finish();
}
