import { SplatFileError } from '../../../data/errors.ts';
import { colorDcOf, logitOf, tableOfBytes } from '../../../data/splats/color-values.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { readAll } from '../../sources/read-all.ts';
import { ArrivingRows, type RowSource } from '../arriving-rows.ts';
import { checkCount } from '../check-count.ts';
import { type DecodedRows, deliverRows, rowLength } from '../decoded-rows.ts';
import { logScaleOf } from '../flat-scale.ts';
import { type ReadFormat, SNIFF_BYTES } from '../read-format.ts';
import { takesCount } from '../row-sink.ts';

const ROW_BYTES = 32;
/** Rows that judge a .splat, which only its name tells: as many bytes as tell other formats. */
const ROWS_JUDGED = SNIFF_BYTES / ROW_BYTES;
/** In any unit, scenes are far smaller. */
const MOST_LENGTH = 1e9;
/** Thinner splats are flat, written as 0. Integers of 32 bits, taken for float32, are far less. */
const LEAST_SCALE = 1e-12;
const ROW_LENGTH = rowLength(0);

const COLORS = tableOfBytes(colorDcOf);
const LOGITS = tableOfBytes(logitOf);
/**
 * Parts of rotations were multiplied by 128 and moved by 128. Most writers then cut off the
 * fraction, so that the middle of a step is nearest; 0 is too common to be moved, too.
 */
const ROTATIONS = Float32Array.from({ length: 256 }, (_, byte) => (byte === 128 ? 0 : (byte - 127.5) / 128));

/**
 * Reads a `.splat`, little-endian rows of: position, 3 × f32; scale as it is, 3 × f32; red, green,
 * blue, opacity, a byte each; rotation w x y z, a byte each, where 128 is 0 and a step is 1/128, in
 * which the middle is meant.
 *
 * An opacity of 0 or 255 is a logit of ±Infinity. A scale of 0 is read as flat (`logScaleOf`):
 * splats of 2DGS, which lack the third, are written so. A row with a negative one is dropped, like
 * one that is not finite.
 *
 * Among the first rows, those with positions or scales that no scene has tell other files: more
 * than a half of them is too many, and more than a tenth makes a note.
 *
 * Rows for the GPU, and those of pieces, are decoded as they arrive, if the file's size is certain.
 *
 * Rejects with `SplatFileError`: 'truncated' if the last row is not whole; 'unknown-format' for
 * other files; 'too-large', 'empty'.
 */
export const read: ReadFormat = async (input, options, rowsTo) => {
  const { name: file, reader, totalBytes, totalBytesCertain, isHeld } = input;
  const countOf = (byteCount: number) => {
    checkCount(Math.ceil(byteCount / ROW_BYTES), file, options.maxSplats);
    if (byteCount % ROW_BYTES === 0) return byteCount / ROW_BYTES;
    const message = `${byteCount} bytes are no whole number of splats of ${ROW_BYTES}. It is cut off, or no .splat file at all.`;
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
    return deliverRows(rows, input, options, rowsTo);
  };
  const knownCount = totalBytesCertain && totalBytes !== undefined ? countOf(totalBytes) : undefined;
  const isPassed = knownCount !== undefined && rowsTo !== undefined && takesCount(rowsTo.files, knownCount);
  if (knownCount !== undefined && (isPassed || options.onPiece)) {
    const arriving = new ArrivingRows(input, ROW_BYTES, (byte) => `at byte ${byte}`);
    return deliver(knownCount, await reader.peek(SNIFF_BYTES), arriving, arriving.arrive);
  }
  // One byte more than may be there tells that there are too many.
  const mostBytes = options.maxSplats * ROW_BYTES + 1;
  const bytes = await readAll(reader, mostBytes, isHeld && knownCount !== undefined ? totalBytes : 0);
  return deliver(countOf(bytes.length), bytes, { bytes, start: 0 });
};

/** Returns notes on a file by its first rows. @throws SplatFileError 'unknown-format' */
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
