import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { coefficientsPerSplat } from '../../../data/splats/splat-set.ts';
import { unpackedLimit } from '../../sources/read-limits.ts';
import type { ReadFormat, SplatInput } from '../read-format.ts';
import { type DecodedRows, deliverRows, rowLength } from '../rows/decoded-rows.ts';
import { checkCount } from '../rows/splat-counts.ts';
import { columnsOfSplats, decodeKey, harmonicsOfSplats } from './decode-frame.ts';
import {
  checkUnpacked,
  factsOf,
  HEADER_BYTES,
  headerBytesOf,
  readFrameCount,
  readHeader,
} from './frames-layout.ts';

/**
 * Reads the first frame, and nothing beyond it. A splat's row is its index in the frame.
 *
 * Rejects with `SplatFileError`: 'damaged', 'bad-header', 'truncated', 'too-large', 'empty'.
 */
export const read: ReadFormat = async (input, options, rowsTo) => {
  const { name: file, reader } = input;
  const headerBytes = headerBytesOf(readFrameCount(await reader.peek(HEADER_BYTES), file));
  const header = readHeader(await reader.peek(headerBytes), file);
  const { isAntialiased } = header;
  const [entry] = header.entries;
  checkCount(entry.splatCount, file, options.maxSplats);
  checkUnpacked(entry, file, unpackedLimit(options, input));
  reader.advance(headerBytes);
  const bytes = await bytesOfFrame(input, entry.bytes);
  const key = await decodeKey({ file, number: 0, entry, bytes });
  const set = columnsOfSplats(key, null);
  const { coefficients } = harmonicsOfSplats(key, null);
  const length = rowLength(entry.shDegree);
  const width = coefficientsPerSplat(entry.shDegree);
  let next = 0;
  const decode: DecodedRows['decode'] = (values, rowCount) => {
    for (let at = 0; at < rowCount * length; at += length, next++) {
      for (let axis = 0; axis < 3; axis++) {
        values[at + ROW_SLOT.position + axis] = set.positions[3 * next + axis];
        values[at + ROW_SLOT.logScale + axis] = set.logScales[3 * next + axis];
        values[at + ROW_SLOT.colorDc + axis] = set.colorDc[3 * next + axis];
      }
      for (let k = 0; k < 4; k++) values[at + ROW_SLOT.rotation + k] = set.rotations[4 * next + k];
      values[at + ROW_SLOT.opacity] = set.opacityLogits[next];
      for (let k = 0; k < width; k++) values[at + ROW_SLOT.harmonics + k] = coefficients[next * width + k];
    }
  };
  const { count, origin } = set;
  const { length: frameCount } = header.entries;
  const note = `Only the first of its ${frameCount} frames is shown. A sequence plays them all: see openFrames.`;
  const fileFacts = { ...factsOf(header), ...(frameCount > 1 && { notes: [note] }) };
  const rows = { count, shDegree: entry.shDegree, origin, isAntialiased, fileFacts, decode };
  return deliverRows(rows, input, options, rowsTo);
};

/** The next bytes, all that are left if the file ends before. */
async function bytesOfFrame({ reader }: SplatInput, byteCount: number): Promise<Uint8Array<ArrayBuffer>> {
  await reader.fill(byteCount);
  const length = Math.min(byteCount, reader.available);
  // Copied, because the reader reuses its memory.
  const bytes = reader.bytes.slice(reader.start, reader.start + length);
  reader.advance(length);
  return bytes;
}
