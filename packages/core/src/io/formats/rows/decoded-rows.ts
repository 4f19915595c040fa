import type { Vec3 } from '../../../data/math/mat4.ts';
import type { PackedHarmonics } from '../../../data/packing/harmonics.ts';
import { type RowLayout, type RowPalette, rowsWithin } from '../../../data/packing/row-layout.ts';
import { ROW_SLOT, reasonToDrop } from '../../../data/splats/splat-row.ts';
import {
  coefficientsPerSplat,
  type FileFacts,
  type ShDegree,
  type SplatSet,
} from '../../../data/splats/splat-set.ts';
import type { SplatFormatOptions, SplatInput } from '../read-format.ts';
import { type ByteHarmonics, copyRows, isShorter } from './byte-harmonics.ts';
import { CoarsePlaces } from './coarse-places.ts';
import { ReadProgress } from './progress.ts';
import { type Passed, type RowSink, type RowsTo, takesCount } from './row-sink.ts';
import { checkCount } from './splat-counts.ts';
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
  /** The harmonics of these rows, for sinks; absent unless they are bytes in the file. */
  readonly byteHarmonics?: ByteHarmonics;
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
  { count, shDegree, origin, palette, isAntialiased, fileFacts, arrive, ...rows }: DecodedRows,
  { reader }: SplatInput,
  { sink, files }: RowsTo,
  progress: ReadProgress,
): Promise<void> {
  const bytes = rows.byteHarmonics && isShorter(rows.byteHarmonics) ? rows.byteHarmonics : undefined;
  const length = floatsPerRow(shDegree, palette, bytes);
  const { decode } = palette ?? rows;
  const strideBytes = 4 * length + (bytes?.strideBytes ?? 0);
  const pieceRows = rowsWithin(files.pieceBytes, strideBytes);
  const coarsePlaces = origin && new CoarsePlaces();
  const offsets = Array.from({ length }, (_, slot) => 4 * slot);
  const layout: RowLayout = {
    count,
    strideBytes,
    pieceRows,
    offsets: [...offsets, ...(bytes?.offsets ?? [])],
    isBigEndian: false,
    shDegree,
    origin,
    ...(palette && { palette: { entryCount: palette.entryCount, entryValues: palette.entryValues } }),
    ...(bytes && { byteHarmonics: { strideBytes: bytes.strideBytes, values: bytes.values } }),
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
      const next = values.subarray(done * length);
      if (bytes) {
        bytes.decodeGeometry(next, nextRows, length);
        copyRows(bytes, memory.subarray(4 * values.length + done * bytes.strideBytes), nextRows);
      } else decode(next, nextRows);
      progress.report(row + done);
      await reader.pause();
    }
    if (coarsePlaces) addRows(coarsePlaces, values, length);
    sink.take(rowCount, memory);
  }
  if (coarsePlaces?.note !== undefined) sink.note?.(coarsePlaces.note);
  // Releases the bytes of the last rows, so that progress counts them.
  await arrive?.(0);
}

function floatsPerRow(
  shDegree: ShDegree,
  palette: DecodedPalette | undefined,
  bytes: ByteHarmonics | undefined,
): number {
  if (palette) return ROW_SLOT.harmonics + 1;
  return bytes ? ROW_SLOT.harmonics : rowLength(shDegree);
}

/** Moves rows to an origin and drops invalid rows. @param length values per row. */
function addRows(coarsePlaces: CoarsePlaces, rows: Float32Array, length: number): void {
  const positions = new Float32Array((3 * rows.length) / length);
  const logScales = new Float32Array(positions.length);
  const row = new Float64Array(length);
  let count = 0;
  for (let at = 0; at < rows.length; at += length) {
    // A view of each row would take longer than its values.
    for (let i = 0; i < length; i++) row[i] = rows[at + i];
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
    isLocal: true,
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
