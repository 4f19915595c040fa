import { SplatFileError } from '../../../data/errors.ts';
import { readGzipped } from '../../containers/gzip.ts';
import { unpackZstd } from '../../containers/zstd.ts';
import { ByteReader } from '../../sources/byte-reader.ts';
import { readAll } from '../../sources/read-all.ts';
import { unpackedLimit } from '../../sources/read-limits.ts';
import { ArrivingRows } from '../arriving-rows.ts';
import { deliverRows } from '../decoded-rows.ts';
import { isGzip } from '../first-bytes.ts';
import type { ReadFormat, SplatFormatOptions, SplatInput } from '../read-format.ts';
import {
  fillOrFail,
  hasStreams,
  readSpzExtensions,
  readSpzHeader,
  type SpzHeader,
  truncated,
} from './spz-header.ts';
import { emptyAttributes, type SpzAttributes, spzAttributeBytes, spzRows } from './spz-rows.ts';

/** Contents of a file, unpacked. */
interface SpzContents {
  readonly header: SpzHeader;
  readonly attributes: SpzAttributes;
  /** Number of the coordinate system that the file names, if it does. */
  readonly coordinateSystem: number | null;
}

type SpzBody = Omit<SpzContents, 'header'>;

const TABLE_ENTRY_BYTES = 16;

/**
 * Reads SPZ, versions 1 to 4. Values are decoded as the format's own library does. Of harmonics,
 * those of degree 4 are left out and the others stay as they are.
 *
 * Splats are turned to the axes of PLY files (right, down, front) if the file names its coordinate
 * system; else they stay as they are: the library says that such files have y up and z to the back,
 * but its own converter, splat-transform and Spark write the axes of the PLY file that they were
 * given, so that the two land alike.
 *
 * Pieces of a file that can be opened again take no more memory than their rows, up to version 3.
 */
export const read: ReadFormat = (input, options, rowsTo) =>
  openSpz(input, options, async (header, unpacked) => {
    if (options.onPiece && unpacked.reopen && !hasStreams(header))
      return deliverFromCursors(header, unpacked, unpacked.reopen, options);
    const { attributes, coordinateSystem } = await readBody(header, unpacked, options);
    return deliverRows(spzRows(header, attributes, coordinateSystem), unpacked, options, rowsTo);
  });

/** Reads all but the meaning of the splats, packed by gzip or not. Rejects with SplatFileError. */
export function readSpzContents(input: SplatInput, options: SplatFormatOptions): Promise<SpzContents> {
  return openSpz(input, options, async (header, unpacked) => ({
    header,
    ...(await readBody(header, unpacked, options)),
  }));
}

/** Reads what follows the header by `read`, unpacked where gzip has packed the file. */
async function openSpz<Result>(
  input: SplatInput,
  options: SplatFormatOptions,
  read: (header: SpzHeader, unpacked: SplatInput) => Promise<Result>,
): Promise<Result> {
  if (isGzip(await input.reader.peek(2)))
    return readGzipped(input, options, (unpacked) => openSpz(unpacked, options, read));
  return read(await readSpzHeader(input.reader, input.name, options.maxSplats), input);
}

function readBody(header: SpzHeader, input: SplatInput, options: SplatFormatOptions): Promise<SpzBody> {
  return hasStreams(header) ? readStreams(header, input, options) : readWhole(header, input);
}

/**
 * Delivers the splats of versions 1 to 3 in pieces, by a reader for each attribute. The file is
 * first read to its end: a piece of a file that is cut off is none.
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

/** Versions 1 to 3: all attributes one after another, then the extensions. */
async function readWhole(header: SpzHeader, input: SplatInput): Promise<SpzBody> {
  const { reader, name } = input;
  const { places, totalBytes } = successionOf(header);
  const bytes = await readBytes(input, totalBytes, splatsOf(header));
  const attributes = emptyAttributes();
  for (const { attribute, start, end } of places)
    attributes[attribute] = { bytes: bytes.subarray(start, end), start: 0 };
  const coordinateSystem = header.hasExtensions ? await readSpzExtensions(reader, name) : null;
  return { attributes, coordinateSystem };
}

/** Where each attribute of versions 1 to 3 begins and ends, behind the header, and their bytes. */
function successionOf(header: SpzHeader) {
  let totalBytes = 0;
  const places = spzAttributeBytes(header).map((size) => {
    const start = totalBytes;
    totalBytes += header.count * size.splatBytes;
    return { ...size, start, end: totalBytes };
  });
  return { places, totalBytes };
}

/** From version 4 on: extensions, a table of sizes, a stream for each attribute with any bytes. */
async function readStreams(
  header: SpzHeader,
  input: SplatInput,
  { maxBytes }: SplatFormatOptions,
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
    const packed = await readBytes(input, size.packedBytes, `the ${attribute}`);
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
  /** Where the table says so. */
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
 * Reads as many bytes, into memory that grows with them unless it is sure that they are there.
 *
 * Rejects with SplatFileError 'truncated'.
 */
async function readBytes(
  { reader, name, isHeld, totalBytes = 0 }: SplatInput,
  byteCount: number,
  what: string,
): Promise<Uint8Array> {
  const heldBytes = isHeld ? Math.max(0, totalBytes - reader.byteOffset) : 0;
  const bytes = await readAll(reader, byteCount, Math.min(byteCount, heldBytes));
  if (bytes.length < byteCount) throw truncated(name, what, reader);
  return bytes;
}

/** @throws SplatFileError 'too-large' where more would be unpacked of so few bytes than may be. */
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
