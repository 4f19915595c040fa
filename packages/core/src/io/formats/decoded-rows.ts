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

/** Rows between two chances of a page's thread to do something else. */
const ROWS_AT_ONCE = 4096;

/** Harmonics that the splats of a file share, for sinks that take them so. */
export interface DecodedPalette extends RowPalette {
  /** The coefficients of all entries, as in rows. Can be called once `arrive` has resolved. */
  values(): Float32Array;
  /** Replaces that of `DecodedRows`, but writes the index of an entry for all harmonics. */
  decode(rows: Float32Array, rowCount: number): void;
}

/** Splats of a file whose bytes are there, or sure to come, to be decoded one after another. */
export interface DecodedRows {
  /** Number of rows. Memory is taken for all: their bytes must be there, or their size certain. */
  readonly count: number;
  readonly shDegree: ShDegree;
  /**
   * Scene-space point, float64, that positions in rows are relative to: the cloud's origin. Absent
   * if positions are the file's own, in float32; the cloud's origin is chosen from them then.
   */
  readonly origin?: Vec3;
  /** Whether the file says that training had an antialias filter; undefined if it does not say. */
  readonly isAntialiased?: boolean;
  readonly fileFacts?: FileFacts;
  /** Waits for the next `rowCount` rows, if they may still arrive. Rejects as `ReadFormat`. */
  arrive?(rowCount: number): Promise<void>;
  /**
   * Writes the next `rowCount` rows into `rows`, which has room for them: each has
   * `rowLength(shDegree)` values by `ROW_SLOT`, as they were trained (log scales, logits, w x y z).
   */
  decode(rows: Float32Array, rowCount: number): void;
  /** Present if rows share their harmonics, unless these are too many to be worth it. */
  readonly palette?: DecodedPalette;
}

/** Values of a row. */
export function rowLength(shDegree: ShDegree): number {
  return ROW_SLOT.harmonics + coefficientsPerSplat(shDegree);
}

/**
 * Delivers decoded rows as `ReadFormat` promises: to `rowsTo`, if it takes as many, or as a set.
 *
 * @param progress of the reading so far, if the scene has several files.
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
  const length = palette ? ROW_SLOT.harmonics + 1 : rowLength(shDegree);
  const { decode } = palette ?? rows;
  const strideBytes = 4 * length;
  const pieceRows = rowsWithin(files.pieceBytes, strideBytes);
  const coarsePlaces = origin && new CoarsePlaces();
  const offsets = Array.from({ length }, (_, slot) => 4 * slot);
  const layout: RowLayout = {
    count,
    strideBytes,
    pieceRows,
    offsets,
    isBigEndian: false,
    shDegree,
    origin,
    ...(palette && { palette: { entryCount: palette.entryCount, entryValues: palette.entryValues } }),
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
    if (coarsePlaces) addRows(coarsePlaces, values, length);
    sink.take(rowCount, memory);
  }
  if (coarsePlaces?.note !== undefined) sink.note?.(coarsePlaces.note);
  // The bytes of the last rows are done with, too: progress counts them.
  await arrive?.(0);
}

/** Adds rows about an origin; drops rows that are no splats. @param length values of each. */
function addRows(coarsePlaces: CoarsePlaces, rows: Float32Array, length: number): void {
  const positions = new Float32Array((3 * rows.length) / length);
  const logScales = new Float32Array(positions.length);
  const row = new Float64Array(length);
  let count = 0;
  for (let at = 0; at < rows.length; at += length) {
    row.set(rows.subarray(at, at + length));
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
