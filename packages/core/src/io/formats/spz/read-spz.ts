import { SplatFileError } from '../../../data/errors.ts';
import { readGzipped } from '../../containers/gzip.ts';
import { unpackZstd } from '../../containers/zstd.ts';
import { ByteReader } from '../../sources/byte-reader.ts';
import { readAll } from '../../sources/read-all.ts';
import { unpackedLimit } from '../../sources/read-limits.ts';
import { isGzip } from '../first-bytes.ts';
import type { ReadFormat, SplatFormatOptions, SplatInput } from '../read-format.ts';
import { ArrivingRows } from '../rows/arriving-rows.ts';
import { deliverRows } from '../rows/decoded-rows.ts';
import { ReadProgress } from '../rows/progress.ts';
import {
  fillOrFail,
  hasStreams,
  readSpzExtensions,
  readSpzHeader,
  type SpzHeader,
  truncated,
} from './spz-header.ts';
import { emptyAttributes, type SpzAttributes, spzAttributeBytes, spzRows } from './spz-rows.ts';

/** Unpacked contents of a file. */
interface SpzContents {
  readonly header: SpzHeader;
  readonly attributes: SpzAttributes;
  /** Number of the coordinate system; null if the file states none. */
  readonly coordinateSystem: number | null;
}

type SpzBody = Omit<SpzContents, 'header'>;

const TABLE_ENTRY_BYTES = 16;

/**
 * Reads SPZ, versions 1 to 4. Values are decoded as the format's own library does. Harmonics of
 * degree 4 are ignored.
 *
 * Splats are rotated to the axes of PLY files (right, down, front) if the file states a coordinate
 * system. Otherwise they stay unchanged. The library specifies y up and z back for such files, but
 * its own converter, splat-transform and Spark write the axes of the source PLY. An unchanged file
 * thus matches its source.
 *
 * Up to version 3, pieces of a reopenable file take no more memory than their rows.
 */
export const read: ReadFormat = (input, options, rowsTo) =>
  openSpz(input, options, async (header, unpacked) => {
    if (options.onPiece && unpacked.reopen && !hasStreams(header))
      return deliverFromCursors(header, unpacked, unpacked.reopen, options);
    const progress = new ReadProgress(unpacked, options.onProgress);
    const { attributes, coordinateSystem } = await readBody(header, unpacked, options, progress.arrived);
    return deliverRows(spzRows(header, attributes, coordinateSystem), unpacked, options, rowsTo, progress);
  });

/** Reads a file, compressed by gzip or not, up to the decoding of splats. Rejects with SplatFileError. */
export function readSpzContents(input: SplatInput, options: SplatFormatOptions): Promise<SpzContents> {
  return openSpz(input, options, async (header, unpacked) => ({
    header,
    ...(await readBody(header, unpacked, options)),
  }));
}

/** Reads the header, then passes the unpacked input to `read`. */
async function openSpz<Result>(
  input: SplatInput,
  options: SplatFormatOptions,
  read: (header: SpzHeader, unpacked: SplatInput) => Promise<Result>,
): Promise<Result> {
  if (isGzip(await input.reader.peek(2)))
    return readGzipped(input, options, (unpacked) => openSpz(unpacked, options, read));
  return read(await readSpzHeader(input.reader, input.name, options.maxSplats), input);
}

function readBody(
  header: SpzHeader,
  input: SplatInput,
  options: SplatFormatOptions,
  onArrived?: () => void,
): Promise<SpzBody> {
  return hasStreams(header)
    ? readStreams(header, input, options, onArrived)
    : readWhole(header, input, onArrived);
}

/**
 * Delivers the splats of versions 1 to 3 in pieces, with one reader per attribute. The file is
 * first read to its end, so that a truncated file delivers no pieces.
 */
async function deliverFromCursors(
  header: SpzHeader,
  input: SplatInput,
  reopen: NonNullable<SplatInput['reopen']>,
  options: SplatFormatOptions,
): ReturnType<ReadFormat> {
  const { reader, name } = input;
  const { places, totalBytes } = successionOf(header);
  const bodyStart = reader.byteOffset;
  if (!(await reader.skip(totalBytes))) throw truncated(name, splatsOf(header), reader);
  const coordinateSystem = header.hasExtensions ? await readSpzExtensions(reader, name) : null;
  const readers: ByteReader[] = [];
  try {
    const cursors: ArrivingRows[] = [];
    const attributes = emptyAttributes();
    for (const { attribute, splatBytes, start } of places) {
      const cursor = new ByteReader({ name, stream: reopen() }, options.signal);
      readers.push(cursor);
      await cursor.skip(bodyStart + start);
      const rows = new ArrivingRows(
        { ...input, reader: cursor },
        splatBytes,
        () => `within the ${attribute}`,
      );
      cursors.push(rows);
      attributes[attribute] = rows;
    }
    const arrive = async (rowCount: number) => {
      for (const cursor of cursors) await cursor.arrive(rowCount);
    };
    const rows = { ...spzRows(header, attributes, coordinateSystem), arrive };
    return await deliverRows(rows, input, options, undefined);
  } finally {
    for (const each of readers) each.close();
  }
}

/** Versions 1 to 3: all attributes in sequence, then the extensions. */
async function readWhole(header: SpzHeader, input: SplatInput, onArrived?: () => void): Promise<SpzBody> {
  const { reader, name } = input;
  const { places, totalBytes } = successionOf(header);
  const bytes = await readBytes(input, totalBytes, splatsOf(header), onArrived);
  const attributes = emptyAttributes();
  for (const { attribute, start, end } of places)
    attributes[attribute] = { bytes: bytes.subarray(start, end), start: 0 };
  const coordinateSystem = header.hasExtensions ? await readSpzExtensions(reader, name) : null;
  return { attributes, coordinateSystem };
}

/** Byte ranges of the attributes of versions 1 to 3, relative to the header's end, and their total. */
function successionOf(header: SpzHeader) {
  let totalBytes = 0;
  const places = spzAttributeBytes(header).map((size) => {
    const start = totalBytes;
    totalBytes += header.count * size.splatBytes;
    return { ...size, start, end: totalBytes };
  });
  return { places, totalBytes };
}

/** Version 4 and above: extensions, a table of sizes, and a stream for each attribute that is not empty. */
async function readStreams(
  header: SpzHeader,
  input: SplatInput,
  { maxBytes }: SplatFormatOptions,
  onArrived?: () => void,
): Promise<SpzBody> {
  const { reader, name } = input;
  const { count, streamCount, tableByte, hasExtensions } = header;
  const coordinateSystem = hasExtensions ? await readSpzExtensions(reader, name, tableByte) : null;
  if (!(await reader.skip(tableByte - reader.byteOffset))) throw truncated(name, 'the extensions', reader);
  const table = await readTable(reader, streamCount, name);
  const sizes = spzAttributeBytes(header).filter(({ splatBytes }) => splatBytes > 0);
  const attributes = emptyAttributes();
  let packedBytes = 0;
  let unpackedBytes = 0;
  for (const [i, { attribute, splatBytes }] of sizes.entries()) {
    const size = table[i];
    if (size.unpackedBytes !== count * splatBytes) {
      const message = `the ${attribute} of ${count} splats take ${count * splatBytes} bytes, but its table says ${size.unpackedBytes}.`;
      throw new SplatFileError('damaged', name, message, { byte: size.byte });
    }
    const place = { byte: reader.byteOffset };
    const packed = await readBytes(input, size.packedBytes, `the ${attribute}`, onArrived);
    packedBytes += packed.length;
    unpackedBytes += size.unpackedBytes;
    checkUnpacked(unpackedBytes, packedBytes, maxBytes, name);
    attributes[attribute] = { bytes: unpackZstd(packed, size.unpackedBytes, name, place), start: 0 };
    await reader.pause();
  }
  if (await reader.fill(1)) {
    const message = 'there are bytes after the last of its streams. Download or export it again.';
    throw new SplatFileError('damaged', name, message, { byte: reader.byteOffset });
  }
  return { attributes, coordinateSystem };
}

function splatsOf({ count }: SpzHeader): string {
  return `the ${count} splats that its header promises`;
}

interface StreamSize {
  readonly packedBytes: number;
  readonly unpackedBytes: number;
  /** Byte offset of the stream's entry in the table. */
  readonly byte: number;
}

async function readTable(reader: ByteReader, streamCount: number, file: string): Promise<StreamSize[]> {
  await fillOrFail(reader, streamCount * TABLE_ENTRY_BYTES, file, 'the table of its streams');
  const { view, start, byteOffset } = reader;
  const table = Array.from({ length: streamCount }, (_, i) => {
    const at = i * TABLE_ENTRY_BYTES;
    return {
      packedBytes: Number(view.getBigUint64(start + at, true)),
      unpackedBytes: Number(view.getBigUint64(start + at + 8, true)),
      byte: byteOffset + at,
    };
  });
  reader.advance(streamCount * TABLE_ENTRY_BYTES);
  return table;
}

/**
 * Reads exactly this many bytes. Memory grows as they arrive, unless all are certain to be present.
 *
 * Rejects with SplatFileError 'truncated'.
 */
async function readBytes(
  { reader, name, isLocal, totalBytes = 0 }: SplatInput,
  byteCount: number,
  what: string,
  onArrived: (() => void) | undefined,
): Promise<Uint8Array> {
  const heldBytes = isLocal ? Math.max(0, totalBytes - reader.byteOffset) : 0;
  const bytes = await readAll(reader, byteCount, Math.min(byteCount, heldBytes), onArrived);
  if (bytes.length < byteCount) throw truncated(name, what, reader);
  return bytes;
}

/** @throws SplatFileError 'too-large' if the unpacked size exceeds the limit for a file of this size. */
function checkUnpacked(
  unpackedBytes: number,
  packedBytes: number,
  maxBytes: number | undefined,
  file: string,
): void {
  const limit = unpackedLimit({ maxBytes }, { totalBytes: packedBytes });
  if (unpackedBytes <= limit) return;
  const message = `it unpacks to ${unpackedBytes} bytes or more, and ${limit} are the limit. Pass a larger maxBytes if that is right.`;
  throw new SplatFileError('too-large', file, message);
}
