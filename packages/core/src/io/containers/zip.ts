import { SplatFileError, type SplatFileErrorCode } from '../../errors.ts';
import type { OpenedSource } from '../sources/splat-source.ts';
import { crc32 } from './crc32.ts';
import { gunzip } from './gzip.ts';
import { DIRECTORY_END, DIRECTORY_ENTRY, LOCAL_HEADER, STORED } from './zip-format.ts';

/** A file in a zip archive. */
export interface ZipEntry {
  /** With its folders, by `/`. */
  readonly path: string;
  readonly method: number;
  readonly crc: number;
  /** Where its packed bytes are. */
  readonly start: number;
  readonly end: number;
  readonly unpackedBytes: number;
}

const MOST_COMMENT = 0xffff;
/** These stand for numbers of a zip64 archive. */
const IN_ZIP64 = { uint16: 0xffff, uint32: 0xffffffff } as const;
const ENCRYPTED = 1;
const DEFLATED = 8;

/** A packed stream is handed over in pieces of this size. */
const PIECE_BYTES = 1 << 18;
const DOWNLOAD_AGAIN = 'Download or export it again';
const UNPACK = 'unpack it, and open what is in it';

/**
 * The files that the directory of a zip archive lists. No two of them share bytes, and none lies outside of the archive.
 *
 * @param bytes of the whole archive.
 * @throws SplatFileError 'truncated', 'damaged'; 'unknown-format' for encrypted, split and zip64 archives
 */
export function readZipDirectory(bytes: Uint8Array<ArrayBuffer>, file: string): ZipEntry[] {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const fail = (code: SplatFileErrorCode, message: string, byte: number): never => {
    throw new SplatFileError(code, file, message, { byte });
  };
  const end = findDirectoryEnd(view);
  if (end < 0)
    return fail('truncated', `it is a zip archive without its last part. ${DOWNLOAD_AGAIN}.`, bytes.length);
  const count = view.getUint16(end + DIRECTORY_END.entries, true);
  const directoryBytes = view.getUint32(end + DIRECTORY_END.directoryBytes, true);
  const directory = view.getUint32(end + DIRECTORY_END.directory, true);
  if (count === IN_ZIP64.uint16 || directoryBytes === IN_ZIP64.uint32 || directory === IN_ZIP64.uint32)
    fail('unknown-format', `it is a zip64 archive; ${UNPACK}.`, end);
  const isSplit =
    view.getUint32(end + DIRECTORY_END.disks, true) !== 0 ||
    view.getUint16(end + DIRECTORY_END.entriesHere, true) !== count;
  if (isSplit) fail('unknown-format', `it is one part of a zip archive that was split; ${UNPACK}.`, end);
  if (directory + directoryBytes > end)
    fail('damaged', `its directory lies outside of it. ${DOWNLOAD_AGAIN}.`, end);

  const entries: ZipEntry[] = [];
  let at = directory;
  for (let i = 0; i < count; i++) {
    const hasHeader =
      at + DIRECTORY_ENTRY.bytes <= end && view.getUint32(at, true) === DIRECTORY_ENTRY.signature;
    if (!hasHeader)
      fail('damaged', `its directory has ${count} files, of which ${i} can be found. ${DOWNLOAD_AGAIN}.`, at);
    const nameEnd = at + DIRECTORY_ENTRY.bytes + view.getUint16(at + DIRECTORY_ENTRY.nameLength, true);
    if (nameEnd > end) fail('damaged', `its directory ends within a name. ${DOWNLOAD_AGAIN}.`, at);
    // Archives made by old programs of Windows have backslashes.
    const path = new TextDecoder()
      .decode(bytes.subarray(at + DIRECTORY_ENTRY.bytes, nameEnd))
      .replaceAll('\\', '/');
    const entry = entryAt(view, at, path, directory, fail);
    if (!path.endsWith('/')) entries.push(entry);
    at =
      nameEnd +
      view.getUint16(at + DIRECTORY_ENTRY.extraLength, true) +
      view.getUint16(at + DIRECTORY_ENTRY.commentLength, true);
  }
  checkApart(entries, fail);
  return entries;
}

type Fail = (code: SplatFileErrorCode, message: string, byte: number) => never;

/** Where the record at the end of an archive begins, which a comment may follow; −1 if there is none. */
function findDirectoryEnd(view: DataView): number {
  const last = view.byteLength - DIRECTORY_END.bytes;
  for (let at = last; at >= Math.max(0, last - MOST_COMMENT); at--) {
    if (view.getUint32(at, true) !== DIRECTORY_END.signature) continue;
    if (at + view.getUint16(at + DIRECTORY_END.commentLength, true) === last) return at;
  }
  return -1;
}

/** The entry that the directory describes at `at`. Files lie before `limit`. */
function entryAt(view: DataView, at: number, path: string, limit: number, fail: Fail): ZipEntry {
  const packedBytes = view.getUint32(at + DIRECTORY_ENTRY.packedBytes, true);
  const unpackedBytes = view.getUint32(at + DIRECTORY_ENTRY.unpackedBytes, true);
  const header = view.getUint32(at + DIRECTORY_ENTRY.localHeader, true);
  if ([packedBytes, unpackedBytes, header].includes(IN_ZIP64.uint32))
    fail('unknown-format', `its file ${path} is a zip64 one; ${UNPACK}.`, at);
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

/** Files that share bytes would let a small archive unpack to a large scene. */
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
 * Opens a file in an archive. What it gives has the length and the CRC-32 of the directory, or the stream fails with
 * SplatFileError 'damaged'.
 *
 * @param bytes of the whole archive.
 * @param name of the file in messages.
 * @throws SplatFileError 'unknown-format' where it is packed in an unusual way
 */
export function openZipEntry(bytes: Uint8Array<ArrayBuffer>, entry: ZipEntry, name: string): OpenedSource {
  const { method, start, end, unpackedBytes } = entry;
  if (method !== STORED && method !== DEFLATED) {
    const message = `it is packed in a way that is not read (method ${method}); unpack the archive.`;
    throw new SplatFileError('unknown-format', name, message, { byte: start });
  }
  const packed = bytes.subarray(start, end);
  const opened = { name, totalBytes: unpackedBytes, totalBytesCertain: true };
  if (method === DEFLATED) return { ...opened, isHeld: false, stream: inflatedStream(packed, entry, name) };
  const pieces = () => checkedPieces(packed, entry, name);
  return {
    ...opened,
    isHeld: true,
    stream: streamOf(pieces),
    unchecked: {
      bytes: packed,
      async check(pause) {
        for (const _ of pieces()) await pause();
      },
    },
  };
}

/** Checks the CRC-32 before the last piece: whoever has read enough may not ask for the end. */
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

/** Puts the packed bytes into a gzip file, whose end has CRC-32 and length: the browser's own code checks them then. */
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
    // Only now is it known that all are right.
    flush(controller) {
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
