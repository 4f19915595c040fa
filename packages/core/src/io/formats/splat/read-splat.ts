import { SplatFileError } from '../../../data/errors.ts';
import { colorDcOf, logitOf, tableOfBytes } from '../../../data/splats/color-values.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { readAll } from '../../sources/read-all.ts';
import { ArrivingRows, type RowSource } from '../arriving-rows.ts';
import { checkCount } from '../check-count.ts';
import { type DecodedRows, deliverRows, rowLength } from '../decoded-rows.ts';
import { logScaleOf } from '../flat-scale.ts';
import { takesCount } from '../row-sink.ts';
import type { ReadFormat } from '../splat-format.ts';

const ROW_BYTES = 32;
const ROW_LENGTH = rowLength(0);

const COLORS = tableOfBytes(colorDcOf);
const LOGITS = tableOfBytes(logitOf);
/**
 * Parts of rotations were multiplied by 128 and moved by 128. Most writers then cut off the fraction, so that the middle of a step is
 * nearest; 0 is too common to be moved, too.
 */
const ROTATIONS = Float32Array.from({ length: 256 }, (_, byte) => (byte === 128 ? 0 : (byte - 127.5) / 128));

/**
 * Reads a `.splat`, little-endian rows of: position, 3 × f32; scale as it is, 3 × f32; red, green, blue, opacity, a byte each; rotation
 * w x y z, a byte each, where 128 is 0 and a step is 1/128, in which the middle is meant.
 *
 * An opacity of 0 or 255 is a logit of ±Infinity. A scale of 0 is read as flat (`logScaleOf`): splats of 2DGS, which lack the third, are
 * written so. A row with a negative one is dropped, as one that is not finite is.
 *
 * Rows that go to the GPU are decoded as they arrive, where the size of the file is certain.
 *
 * Rejects with `SplatFileError`: 'truncated' if the last row is not whole; 'too-large', 'empty'.
 */
export const read: ReadFormat = async (input, options, rowsTo) => {
  const { name: file, reader, totalBytes, totalBytesCertain, isHeld } = input;
  const countOf = (byteCount: number) => {
    checkCount(Math.ceil(byteCount / ROW_BYTES), file, options.maxSplats);
    if (byteCount % ROW_BYTES === 0) return byteCount / ROW_BYTES;
    const message = `${byteCount} bytes are no whole number of splats of ${ROW_BYTES}. It is cut off, or no .splat file at all.`;
    throw new SplatFileError('truncated', file, message, { byte: byteCount });
  };
  const deliver = (count: number, source: RowSource, arrive?: DecodedRows['arrive']) => {
    const rows = {
      count,
      shDegree: 0,
      fileFacts: { format: 'splat' },
      arrive,
      decode: rowDecoder(source),
    } as const;
    return deliverRows(rows, input, options, rowsTo);
  };
  const knownCount = totalBytesCertain && totalBytes !== undefined ? countOf(totalBytes) : undefined;
  if (knownCount !== undefined && rowsTo && takesCount(rowsTo.files, knownCount)) {
    const arriving = new ArrivingRows(input, ROW_BYTES, (byte) => `at byte ${byte}`);
    return deliver(knownCount, arriving, arriving.arrive);
  }
  // One byte more than may be there tells that there are too many.
  const mostBytes = options.maxSplats * ROW_BYTES + 1;
  const bytes = await readAll(reader, mostBytes, isHeld && knownCount !== undefined ? totalBytes : 0);
  return deliver(countOf(bytes.length), { bytes, start: 0 });
};

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
