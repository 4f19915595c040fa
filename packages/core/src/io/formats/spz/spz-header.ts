import { type FilePlace, SplatFileError } from '../../../data/errors.ts';
import type { ByteReader } from '../../sources/byte-reader.ts';
import { latin1, SPZ_MAGIC } from '../first-bytes.ts';
import { checkCount } from '../rows/splat-counts.ts';
import { FLAG_ANTIALIASED, HEADER_BYTES } from './spz-layout.ts';
import { LAST_COORDINATE_SYSTEM } from './turn-axes.ts';

export interface SpzHeader {
  readonly version: number;
  readonly count: number;
  /** Degree of the harmonics in the file, up to 4. */
  readonly fileShDegree: number;
  /** Positions are multiples of 2 to the power of −fractionalBits. */
  readonly fractionalBits: number;
  readonly isAntialiased: boolean;
  readonly hasExtensions: boolean;
  /** Version 4 and above: number of streams, and byte offset of the table of their sizes. */
  readonly streamCount: number;
  readonly tableByte: number;
}

const LAST_VERSION = 4;
const FIRST_VERSION_OF_STREAMS = 4;
const LAST_SH_DEGREE = 4;
const MOST_FRACTIONAL_BITS = 31;
const FLAG_EXTENSIONS = 2;
/** Set by Spark for trees of levels of detail, before version 4. */
const FLAG_TREE = 0x80;
const STREAMS_HEADER_BYTES = 32;

const COORDINATE_SYSTEM_EXTENSION = 0xadbe0003;

/** Whether attributes are separate Zstandard streams instead of one sequence. */
export function hasStreams({ version }: Pick<SpzHeader, 'version'>): boolean {
  return version >= FIRST_VERSION_OF_STREAMS;
}

/**
 * Reads the header.
 *
 * Rejects with SplatFileError 'truncated', 'bad-header', 'unknown-format', 'empty', 'too-large'.
 */
export async function readSpzHeader(reader: ByteReader, file: string, maxSplats: number): Promise<SpzHeader> {
  const bad = (message: string, byte: number) => new SplatFileError('bad-header', file, message, { byte });
  await fillOrFail(reader, HEADER_BYTES, file, 'the header');
  const { view, start } = reader;
  if (latin1(reader.bytes.subarray(start, start + 4)) !== SPZ_MAGIC)
    throw bad(`it is no SPZ, which begins with ${SPZ_MAGIC}; it may be another format under this name.`, 0);
  const version = view.getUint32(start + 4, true);
  const count = view.getUint32(start + 8, true);
  const fileShDegree = view.getUint8(start + 12);
  const fractionalBits = view.getUint8(start + 13);
  const flags = view.getUint8(start + 14);
  const streamCount = view.getUint8(start + 15);
  if (version < 1 || version > LAST_VERSION)
    throw bad(`SPZ of version ${version} is not known; versions 1 to ${LAST_VERSION} are read.`, 4);
  checkCount(count, file, maxSplats, { byte: 8 });
  if (fileShDegree > LAST_SH_DEGREE)
    throw bad(`harmonics of degree ${fileShDegree}; at most ${LAST_SH_DEGREE} is possible.`, 12);
  if (version > 1 && fractionalBits > MOST_FRACTIONAL_BITS)
    throw bad(
      `positions with ${fractionalBits} fractional bits; at most ${MOST_FRACTIONAL_BITS} are possible.`,
      13,
    );
  const header = {
    version,
    count,
    fileShDegree,
    fractionalBits,
    isAntialiased: (flags & FLAG_ANTIALIASED) !== 0,
    hasExtensions: (flags & FLAG_EXTENSIONS) !== 0,
  };
  if (!hasStreams(header)) {
    if (flags & FLAG_TREE) {
      const message = 'it holds a tree of levels of detail, which is not read; export the scene without it.';
      throw new SplatFileError('unknown-format', file, message, { byte: 14 });
    }
    reader.advance(HEADER_BYTES);
    return { ...header, streamCount: 0, tableByte: 0 };
  }
  await fillOrFail(reader, STREAMS_HEADER_BYTES, file, 'the header');
  const tableByte = reader.view.getUint32(reader.start + HEADER_BYTES, true);
  const streamsWanted = fileShDegree === 0 ? 5 : 6;
  if (streamCount !== streamsWanted)
    throw bad(
      `it has ${streamCount} streams; harmonics of degree ${fileShDegree} need ${streamsWanted}.`,
      15,
    );
  if (tableByte < STREAMS_HEADER_BYTES)
    throw bad(`its table begins at byte ${tableByte}, within the header.`, HEADER_BYTES);
  reader.advance(STREAMS_HEADER_BYTES);
  return { ...header, streamCount, tableByte };
}

/**
 * Reads extensions up to byte `end`, or up to the end of the file, at least one. Returns the number
 * of the coordinate system that they state, or null. Other extensions are ignored.
 *
 * Rejects with SplatFileError 'truncated', 'bad-header'.
 */
export async function readSpzExtensions(
  reader: ByteReader,
  file: string,
  end = Number.POSITIVE_INFINITY,
): Promise<number | null> {
  let found: number | null = null;
  for (let count = 0; end - reader.byteOffset >= 8; count++) {
    if (!(await reader.fill(8))) {
      if (count > 0 && reader.available === 0 && end === Number.POSITIVE_INFINITY) break;
      throw truncated(file, 'the extensions', reader);
    }
    const place = { byte: reader.byteOffset };
    const type = reader.view.getUint32(reader.start, true);
    const length = reader.view.getUint32(reader.start + 4, true);
    reader.advance(8);
    if (length > end - reader.byteOffset) {
      const message = `an extension has ${length} bytes, more than there is room for.`;
      throw new SplatFileError('bad-header', file, message, place);
    }
    const next = reader.byteOffset + length;
    if (type === COORDINATE_SYSTEM_EXTENSION) found = await readCoordinateSystem(reader, file, length, place);
    if (!(await reader.skip(next - reader.byteOffset))) throw truncated(file, 'an extension', reader);
    await reader.pause();
  }
  return found;
}

async function readCoordinateSystem(
  reader: ByteReader,
  file: string,
  length: number,
  place: FilePlace,
): Promise<number | null> {
  let system = Number.NaN;
  if (length >= 4) {
    await fillOrFail(reader, 4, file, 'an extension');
    system = reader.view.getUint32(reader.start, true);
  }
  if (!(system <= LAST_COORDINATE_SYSTEM)) {
    const message = `its coordinate system (${system}) is not known; export it with the axes right, down, front.`;
    throw new SplatFileError('bad-header', file, message, place);
  }
  // 0 means unspecified.
  return system || null;
}

/** Rejects with SplatFileError 'truncated' if there are fewer bytes. */
export async function fillOrFail(
  reader: ByteReader,
  byteCount: number,
  file: string,
  what: string,
): Promise<void> {
  if (!(await reader.fill(byteCount))) throw truncated(file, what, reader);
}

export function truncated(file: string, what: string, reader: ByteReader): SplatFileError {
  const byte = reader.byteOffset + reader.available;
  const message = `the file ends within ${what}. Download or export it again.`;
  return new SplatFileError('truncated', file, message, { byte });
}
