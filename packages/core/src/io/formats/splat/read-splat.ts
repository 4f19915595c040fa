import { SplatFileError } from '../../../data/errors.ts';
import { colorDcOf, logitOf, tableOfBytes } from '../../../data/splats/color-values.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { readAll } from '../../sources/read-all.ts';
import { type ReadFormat, SNIFF_BYTES } from '../read-format.ts';
import { ArrivingRows, type RowSource } from '../rows/arriving-rows.ts';
import { type DecodedRows, deliverRows, rowLength } from '../rows/decoded-rows.ts';
import { logScaleOf } from '../rows/flat-scale.ts';
import { ReadProgress } from '../rows/progress.ts';
import { takesCount } from '../rows/row-sink.ts';
import { checkCount } from '../rows/splat-counts.ts';

const ROW_BYTES = 32;
/** Rows that are checked for plausibility, because a .splat has no signature. */
const ROWS_JUDGED = SNIFF_BYTES / ROW_BYTES;
/** Largest plausible coordinate or scale, in any unit. */
const MOST_LENGTH = 1e9;
/**
 * Smaller scales are implausible: flat splats are stored as 0, and 32-bit integers read as float32
 * are far smaller.
 */
const LEAST_SCALE = 1e-12;
const ROW_LENGTH = rowLength(0);

const COLORS = tableOfBytes(colorDcOf);
const LOGITS = tableOfBytes(logitOf);
/**
 * Rotation component of each byte. Writers multiply by 128, add 128 and usually truncate, so the
 * midpoint of a step is nearest. Byte 128 stays exactly 0, because 0 is too common.
 */
const ROTATIONS = Float32Array.from({ length: 256 }, (_, byte) => (byte === 128 ? 0 : (byte - 127.5) / 128));

/**
 * Reads a `.splat`: little-endian rows of 32 bytes.
 *
 * - position: 3 × f32
 * - scale: 3 × f32, linear
 * - red, green, blue, opacity: one byte each
 * - rotation w x y z: one byte each; 128 is 0, a step is 1/128, and its midpoint is used
 *
 * An opacity of 0 or 255 is a logit of ±Infinity. A scale of 0 is read as flat (`logScaleOf`): 2DGS
 * splats lack the third scale. Rows with a negative scale, or with a value that is not finite, are
 * dropped.
 *
 * The first rows are checked for implausible positions and scales. If more than half are
 * implausible, the file is rejected; more than a tenth gives a note.
 *
 * Rows for a sink, and pieces, are decoded as they arrive, if the file's size is certain.
 *
 * Rejects with `SplatFileError`: 'truncated' if the last row is incomplete; 'unknown-format' for
 * other files; 'too-large', 'empty'.
 */
export const read: ReadFormat = async (input, options, rowsTo) => {
  const progress = new ReadProgress(input, options.onProgress);
  const { name: file, reader, totalBytes, totalBytesCertain, isLocal } = input;
  const countOf = (byteCount: number) => {
    checkCount(Math.ceil(byteCount / ROW_BYTES), file, options.maxSplats);
    if (byteCount % ROW_BYTES === 0) return byteCount / ROW_BYTES;
    const message = `it is cut off, or is not a .splat file: ${byteCount} bytes are not a multiple of ${ROW_BYTES}, the bytes of a splat`;
    throw new SplatFileError('truncated', file, message, { byte: byteCount });
  };
  const deliver = (
    count: number,
    firstBytes: Uint8Array,
    source: RowSource,
    arrive?: DecodedRows['arrive'],
  ) => {
    const notes = judge(firstBytes, file);
    const rows = {
      count,
      shDegree: 0,
      fileFacts: { format: 'splat', ...(notes.length > 0 && { notes }) },
      arrive,
      decode: rowDecoder(source),
    } as const;
    return deliverRows(rows, input, options, rowsTo, progress);
  };
  const knownCount = totalBytesCertain && totalBytes !== undefined ? countOf(totalBytes) : undefined;
  const isPassed = knownCount !== undefined && rowsTo !== undefined && takesCount(rowsTo.files, knownCount);
  if (knownCount !== undefined && (isPassed || options.onPiece)) {
    const arriving = new ArrivingRows(input, ROW_BYTES, (byte) => `at byte ${byte}`);
    return deliver(knownCount, await reader.peek(SNIFF_BYTES), arriving, arriving.arrive);
  }
  // One byte above the limit reveals a file that is too large.
  const mostBytes = options.maxSplats * ROW_BYTES + 1;
  const bytes = await readAll(
    reader,
    mostBytes,
    isLocal && knownCount !== undefined ? totalBytes : 0,
    progress.arrived,
  );
  return deliver(countOf(bytes.length), bytes, { bytes, start: 0 });
};

/** Returns notes about a file from its first rows. @throws SplatFileError 'unknown-format' */
function judge(firstBytes: Uint8Array, file: string): string[] {
  const view = new DataView(firstBytes.buffer, firstBytes.byteOffset, firstBytes.length);
  const rowCount = Math.min(ROWS_JUDGED, Math.floor(firstBytes.length / ROW_BYTES));
  const vector = (at: number) => [0, 4, 8].map((byte) => view.getFloat32(at + byte, true));
  let absurd = 0;
  for (let at = 0; at < rowCount * ROW_BYTES; at += ROW_BYTES) {
    const scales = vector(at + 12);
    const isPlaced = vector(at).every((value) => Math.abs(value) < MOST_LENGTH);
    const isSized = scales.every((scale) => scale === 0 || (scale > LEAST_SCALE && scale < MOST_LENGTH));
    if (!isPlaced || !isSized || scales.every((scale) => scale === 0)) absurd++;
  }
  if (10 * absurd <= rowCount) return [];
  const found = `${absurd} of its first ${rowCount} rows have positions or scales that no scene has`;
  if (2 * absurd <= rowCount) return [`${found}; it may be damaged, or no .splat file.`];
  throw new SplatFileError('unknown-format', file, `${found}. It is no .splat file, or a damaged one.`);
}

function rowDecoder(source: RowSource): (rows: Float32Array, rowCount: number) => void {
  return (rows, rowCount) => {
    const { bytes } = source;
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
    let from = source.start;
    for (let at = 0; at < rowCount * ROW_LENGTH; at += ROW_LENGTH, from += ROW_BYTES) {
      for (let i = 0; i < 3; i++) {
        rows[at + ROW_SLOT.position + i] = view.getFloat32(from + 4 * i, true);
        rows[at + ROW_SLOT.logScale + i] = logScaleOf(view.getFloat32(from + 12 + 4 * i, true));
        rows[at + ROW_SLOT.colorDc + i] = COLORS[bytes[from + 24 + i]];
      }
      rows[at + ROW_SLOT.opacity] = LOGITS[bytes[from + 27]];
      for (let i = 0; i < 4; i++) rows[at + ROW_SLOT.rotation + i] = ROTATIONS[bytes[from + 28 + i]];
    }
    source.start = from;
  };
}
