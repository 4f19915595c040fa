import { type FileFinding, SplatFileError, type SplatFileErrorCode } from '../../data/errors.ts';
import type { OpenedSource } from '../sources/splat-source.ts';
import { crc32 } from './crc32.ts';
import { gunzip } from './gzip.ts';
import {
  DIRECTORY_END,
  DIRECTORY_ENTRY,
  LOCAL_HEADER,
  STORED,
  ZIP64_END,
  ZIP64_EXTRA_ID,
  ZIP64_LOCATOR,
} from './zip-format.ts';

/** A file in a zip archive. */
export interface ZipEntry {
  /** Path with `/` between folders. */
  readonly path: string;
  readonly method: number;
  readonly crc: number;
  /** Offset of its packed bytes. */
  readonly start: number;
  readonly end: number;
  readonly unpackedBytes: number;
}

const MOST_COMMENT = 0xffff;
/** Placeholders for numbers that are stored in a zip64 record. */
const IN_ZIP64 = { uint16: 0xffff, uint32: 0xffffffff } as const;
/** Bytes before the contents of an extra field: its id and its length. */
const EXTRA_HEADER_BYTES = 4;
const ENCRYPTED = 1;
const DEFLATED = 8;

/** Bytes per piece of a packed stream. */
const PIECE_BYTES = 1 << 18;
const DOWNLOAD_AGAIN = 'Download or export it again';
const UNPACK = 'unpack it, and open what is in it';

/**
 * Reads the directory of a zip archive. Entries do not overlap and lie within the archive.
 *
 * @param bytes the whole archive.
 * @throws SplatFileError 'truncated', 'damaged'; 'unknown-format' for encrypted and split archives
 */
export function readZipDirectory(bytes: Uint8Array<ArrayBuffer>, file: string): ZipEntry[] {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const fail = (code: SplatFileErrorCode, problem: string | FileFinding, byte: number): never => {
    throw new SplatFileError(code, file, problem, { byte });
  };
  const { count, directory, end } = directoryPlace(view, fail);
  const entries: ZipEntry[] = [];
  const decoder = new TextDecoder();
  let at = directory;
  for (let i = 0; i < count; i++) {
    const hasHeader =
      at + DIRECTORY_ENTRY.bytes <= end && view.getUint32(at, true) === DIRECTORY_ENTRY.signature;
    if (!hasHeader)
      fail('damaged', `its directory has ${count} files, of which ${i} can be found. ${DOWNLOAD_AGAIN}.`, at);
    const nameEnd = at + DIRECTORY_ENTRY.bytes + view.getUint16(at + DIRECTORY_ENTRY.nameLength, true);
    if (nameEnd > end) fail('damaged', `its directory ends within a name. ${DOWNLOAD_AGAIN}.`, at);
    // Archives from old Windows programs have backslashes.
    const path = decoder.decode(bytes.subarray(at + DIRECTORY_ENTRY.bytes, nameEnd)).replaceAll('\\', '/');
    const extraEnd = nameEnd + view.getUint16(at + DIRECTORY_ENTRY.extraLength, true);
    if (extraEnd > end) fail('damaged', `its directory ends within ${path}. ${DOWNLOAD_AGAIN}.`, at);
    const wide = zip64Field(view, nameEnd, extraEnd);
    const entry = entryAt(view, at, path, wide, directory, fail);
    if (!path.endsWith('/')) entries.push(entry);
    at = extraEnd + view.getUint16(at + DIRECTORY_ENTRY.commentLength, true);
  }
  checkApart(entries, fail);
  return entries;
}

type Fail = (code: SplatFileErrorCode, problem: string | FileFinding, byte: number) => never;

interface DirectoryPlace {
  readonly count: number;
  /** Offset of the first entry. */
  readonly directory: number;
  /** Offset of the records after the directory. */
  readonly end: number;
}

/** Locates the directory by the records at the end of the archive. */
function directoryPlace(view: DataView, fail: Fail): DirectoryPlace {
  const end = findDirectoryEnd(view);
  if (end < 0)
    return fail(
      'truncated',
      `it is a zip archive without its last part. ${DOWNLOAD_AGAIN}.`,
      view.byteLength,
    );
  const wide = findZip64End(view, end, fail);
  const number16 = (at: number, wideAt: number, wideBytes: 4 | 8) => {
    const value = view.getUint16(end + at, true);
    if (wide === null || value !== IN_ZIP64.uint16) return value;
    return wideBytes === 4 ? view.getUint32(wide + wideAt, true) : uint64(view, wide + wideAt);
  };
  const number32 = (at: number, wideAt: number) => {
    const value = view.getUint32(end + at, true);
    return wide === null || value !== IN_ZIP64.uint32 ? value : uint64(view, wide + wideAt);
  };
  const count = number16(DIRECTORY_END.entries, ZIP64_END.entries, 8);
  const isSplit =
    number16(DIRECTORY_END.disk, ZIP64_END.disk, 4) !== 0 ||
    number16(DIRECTORY_END.directoryDisk, ZIP64_END.directoryDisk, 4) !== 0 ||
    number16(DIRECTORY_END.entriesHere, ZIP64_END.entriesHere, 8) !== count;
  if (isSplit) fail('unknown-format', ['is one part of a zip archive that was split', UNPACK], end);
  const directory = number32(DIRECTORY_END.directory, ZIP64_END.directory);
  const directoryBytes = number32(DIRECTORY_END.directoryBytes, ZIP64_END.directoryBytes);
  const recordsAt = wide ?? end;
  if (directory + directoryBytes > recordsAt)
    fail('damaged', `its directory lies outside of it. ${DOWNLOAD_AGAIN}.`, end);
  return { count, directory, end: recordsAt };
}

/** Offset of the end record, which a comment may follow; −1 if there is none. */
function findDirectoryEnd(view: DataView): number {
  const last = view.byteLength - DIRECTORY_END.bytes;
  for (let at = last; at >= Math.max(0, last - MOST_COMMENT); at--) {
    if (view.getUint32(at, true) !== DIRECTORY_END.signature) continue;
    if (at + view.getUint16(at + DIRECTORY_END.commentLength, true) === last) return at;
  }
  return -1;
}

/** Offset of the zip64 end record; null if there is none. */
function findZip64End(view: DataView, end: number, fail: Fail): number | null {
  const locator = end - ZIP64_LOCATOR.bytes;
  if (locator < 0 || view.getUint32(locator, true) !== ZIP64_LOCATOR.signature) return null;
  const at = uint64(view, locator + ZIP64_LOCATOR.end);
  const isThere = at + ZIP64_END.bytes <= locator && view.getUint32(at, true) === ZIP64_END.signature;
  if (!isThere) fail('damaged', `its zip64 record is not where its end says. ${DOWNLOAD_AGAIN}.`, locator);
  return at;
}

/** Location of an entry's zip64 field between `from` and `to`; null if there is none. */
function zip64Field(view: DataView, from: number, to: number): { at: number; end: number } | null {
  for (let at = from; at + EXTRA_HEADER_BYTES <= to; ) {
    const start = at + EXTRA_HEADER_BYTES;
    const end = start + view.getUint16(at + 2, true);
    if (view.getUint16(at, true) === ZIP64_EXTRA_ID && end <= to) return { at: start, end };
    at = end;
  }
  return null;
}

/** Exact below 2⁵³; a larger number exceeds every archive and is refused. */
function uint64(view: DataView, at: number): number {
  return Number(view.getBigUint64(at, true));
}

/**
 * Reads the directory entry at `at`. File data must end before `limit`.
 *
 * @param wide location of its zip64 field. The field holds the numbers that exceed 32 bits, in the
 *   order in which they are read here.
 */
function entryAt(
  view: DataView,
  at: number,
  path: string,
  wide: { at: number; end: number } | null,
  limit: number,
  fail: Fail,
): ZipEntry {
  let wideAt = wide?.at ?? 0;
  const numberAt = (field: number): number => {
    const value = view.getUint32(at + field, true);
    if (value !== IN_ZIP64.uint32) return value;
    if (wide === null || wideAt + 8 > wide.end)
      fail('damaged', `its file ${path} lacks a number that zip64 needs. ${DOWNLOAD_AGAIN}.`, at);
    wideAt += 8;
    return uint64(view, wideAt - 8);
  };
  const unpackedBytes = numberAt(DIRECTORY_ENTRY.unpackedBytes);
  const packedBytes = numberAt(DIRECTORY_ENTRY.packedBytes);
  const header = numberAt(DIRECTORY_ENTRY.localHeader);
  const flags = view.getUint16(at + DIRECTORY_ENTRY.flags, true);
  if ((flags & ENCRYPTED) !== 0) fail('unknown-format', `its file ${path} is encrypted; ${UNPACK}.`, at);
  const isThere =
    header + LOCAL_HEADER.bytes <= limit && view.getUint32(header, true) === LOCAL_HEADER.signature;
  if (!isThere) fail('damaged', `its file ${path} is not where its directory says. ${DOWNLOAD_AGAIN}.`, at);
  const start =
    header +
    LOCAL_HEADER.bytes +
    view.getUint16(header + LOCAL_HEADER.nameLength, true) +
    view.getUint16(header + LOCAL_HEADER.extraLength, true);
  if (start + packedBytes > limit)
    fail('damaged', `its file ${path} does not end where its directory says. ${DOWNLOAD_AGAIN}.`, at);
  const method = view.getUint16(at + DIRECTORY_ENTRY.method, true);
  if (method === STORED && packedBytes !== unpackedBytes)
    fail('damaged', `its file ${path} is not packed, but has two sizes. ${DOWNLOAD_AGAIN}.`, at);
  return {
    path,
    method,
    crc: view.getUint32(at + DIRECTORY_ENTRY.crc, true),
    start,
    end: start + packedBytes,
    unpackedBytes,
  };
}

/** Overlapping files would let a small archive unpack to a large scene. */
function checkApart(entries: readonly ZipEntry[], fail: Fail): void {
  let before = 0;
  for (const { path, start, end } of [...entries].sort((a, b) => a.start - b.start)) {
    if (start < before) fail('damaged', `its file ${path} begins within another. ${DOWNLOAD_AGAIN}.`, start);
    before = end;
  }
  const paths = new Set<string>();
  for (const { path, start } of entries) {
    if (paths.has(path)) fail('damaged', `it has two files ${path}. ${DOWNLOAD_AGAIN}.`, start);
    paths.add(path);
  }
}

/**
 * Opens a file in an archive. The stream fails with SplatFileError 'damaged' if length or CRC-32
 * differ from the directory.
 *
 * @param bytes the whole archive.
 * @param name file name in messages.
 * @throws SplatFileError 'unknown-format' for unsupported compression methods
 */
export function openZipEntry(bytes: Uint8Array<ArrayBuffer>, entry: ZipEntry, name: string): OpenedSource {
  const { method, start, end, unpackedBytes } = entry;
  if (method !== STORED && method !== DEFLATED) {
    const finding: FileFinding = [
      `is packed in a way that is not read (method ${method})`,
      'unpack the archive',
    ];
    throw new SplatFileError('unknown-format', name, finding, { byte: start });
  }
  const packed = bytes.subarray(start, end);
  const opened = { name, totalBytes: unpackedBytes, totalBytesCertain: true };
  if (method === DEFLATED) return { ...opened, isLocal: false, stream: inflatedStream(packed, entry, name) };
  const pieces = () => checkedPieces(packed, entry, name);
  return {
    ...opened,
    isLocal: true,
    stream: streamOf(pieces),
    unchecked: {
      bytes: packed,
      async check(pause) {
        for (const _ of pieces()) await pause();
      },
    },
  };
}

/** Checks the CRC-32 before the last piece: a reader with enough bytes may not read to the end. */
function* checkedPieces(
  bytes: Uint8Array<ArrayBuffer>,
  entry: ZipEntry,
  name: string,
): Generator<Uint8Array<ArrayBuffer>> {
  let crc = 0;
  let given = 0;
  for (const piece of piecesOf(bytes)) {
    crc = crc32(piece, crc);
    given += piece.length;
    if (given === bytes.length && crc !== entry.crc) {
      const message = `its bytes are not those that were packed (CRC-32 differs). ${DOWNLOAD_AGAIN}.`;
      throw new SplatFileError('damaged', name, message);
    }
    yield piece;
  }
}

/** Wraps packed bytes as a gzip file, so that the browser checks CRC-32 and length. */
function inflatedStream(
  packed: Uint8Array<ArrayBuffer>,
  { crc, start, unpackedBytes }: ZipEntry,
  name: string,
): ReadableStream<Uint8Array> {
  const header = Uint8Array.of(0x1f, 0x8b, DEFLATED, 0, 0, 0, 0, 0, 0, 0xff);
  const trailer = new DataView(new ArrayBuffer(8));
  trailer.setUint32(0, crc, true);
  trailer.setUint32(4, unpackedBytes, true);
  const gzip = streamOf(function* () {
    yield header;
    yield* piecesOf(packed);
    yield new Uint8Array(trailer.buffer);
  });
  let given = 0;
  let last: Uint8Array | undefined;
  const checking = new TransformStream<Uint8Array, Uint8Array>({
    transform(piece, controller) {
      given += piece.length;
      if (given > unpackedBytes) {
        const message = `it unpacks to more than its ${unpackedBytes} bytes. ${DOWNLOAD_AGAIN}.`;
        throw new SplatFileError('damaged', name, message);
      }
      if (last) controller.enqueue(last);
      last = piece;
    },
    // The length is checked here, because gzip stores only its low 32 bits.
    flush(controller) {
      if (given < unpackedBytes) {
        const message = `it unpacks to ${given} bytes, fewer than its ${unpackedBytes}. ${DOWNLOAD_AGAIN}.`;
        throw new SplatFileError('damaged', name, message);
      }
      if (last) controller.enqueue(last);
    },
  });
  return gunzip(gzip, name, () => start).pipeThrough(checking);
}

function* piecesOf(bytes: Uint8Array<ArrayBuffer>): Generator<Uint8Array<ArrayBuffer>> {
  for (let at = 0; at < bytes.length; at += PIECE_BYTES) yield bytes.subarray(at, at + PIECE_BYTES);
}

function streamOf(pieces: () => Generator<Uint8Array<ArrayBuffer>>): ReadableStream<Uint8Array<ArrayBuffer>> {
  const iterator = pieces();
  return new ReadableStream(
    {
      pull(controller) {
        const { done, value } = iterator.next();
        if (done) controller.close();
        else controller.enqueue(value);
      },
    },
    { highWaterMark: 0 },
  );
}
