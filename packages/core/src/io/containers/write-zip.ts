import { InvalidArgumentError } from '../../data/errors.ts';
import { shown } from '../../data/printable.ts';
import { isInnerPath } from '../sources/inner-path.ts';
import { crc32 } from './crc32.ts';
import { DIRECTORY_END, DIRECTORY_ENTRY, LOCAL_HEADER, STORED } from './zip-format.ts';

/** Version needed to extract stored files. */
const VERSION = 20;
/** Flag: names are in UTF-8. */
const UTF8 = 1 << 11;
/** 1 January 1980, the earliest date: equal files make equal archives. */
const DATE = (1 << 5) | 1;

/**
 * Puts files into a zip archive, uncompressed.
 *
 * @param files contents by path, with `/` between folders; at most 65,534 files, and less than 4
 *   GiB in all.
 * @throws InvalidArgumentError 'files' for a path that may lead out of the folder where the archive
 *   is unpacked; RangeError if no ArrayBuffer can be that large
 * @example
 * const scene = encodePly(await readSplats('/garden.spz'));
 * const notes = new TextEncoder().encode('Captured in May.');
 * const file = new File([zipFiles({ 'garden.ply': scene, 'notes.txt': notes })], 'garden.zip');
 */
export function zipFiles(files: Readonly<Record<string, Uint8Array>>): Uint8Array<ArrayBuffer> {
  const outer = Object.keys(files).find((path) => !isInnerPath(path));
  if (outer !== undefined) {
    const message = `files has "${shown(outer)}", which may lie outside of the archive's folder; give it another path.`;
    throw new InvalidArgumentError('files', message);
  }
  const entries = Object.entries(files).map(([path, bytes]) => ({
    name: new TextEncoder().encode(path),
    bytes,
    crc: crc32(bytes),
  }));
  const headersBytes = LOCAL_HEADER.bytes + DIRECTORY_ENTRY.bytes;
  const length = entries.reduce<number>(
    (sum, { name, bytes }) => sum + headersBytes + 2 * name.length + bytes.length,
    DIRECTORY_END.bytes,
  );
  const zip = new Uint8Array(length);
  const view = new DataView(zip.buffer);
  let at = 0;
  const headerAts: number[] = [];
  for (const { name, bytes, crc } of entries) {
    headerAts.push(at);
    view.setUint32(at, LOCAL_HEADER.signature, true);
    view.setUint16(at + LOCAL_HEADER.version, VERSION, true);
    view.setUint16(at + LOCAL_HEADER.flags, UTF8, true);
    view.setUint16(at + LOCAL_HEADER.date, DATE, true);
    view.setUint32(at + LOCAL_HEADER.crc, crc, true);
    view.setUint32(at + LOCAL_HEADER.packedBytes, bytes.length, true);
    view.setUint32(at + LOCAL_HEADER.unpackedBytes, bytes.length, true);
    view.setUint16(at + LOCAL_HEADER.nameLength, name.length, true);
    zip.set(name, at + LOCAL_HEADER.bytes);
    zip.set(bytes, at + LOCAL_HEADER.bytes + name.length);
    at += LOCAL_HEADER.bytes + name.length + bytes.length;
  }
  const directory = at;
  entries.forEach(({ name, bytes, crc }, i) => {
    view.setUint32(at, DIRECTORY_ENTRY.signature, true);
    view.setUint16(at + DIRECTORY_ENTRY.writerVersion, VERSION, true);
    view.setUint16(at + DIRECTORY_ENTRY.version, VERSION, true);
    view.setUint16(at + DIRECTORY_ENTRY.flags, UTF8, true);
    view.setUint16(at + DIRECTORY_ENTRY.method, STORED, true);
    view.setUint16(at + DIRECTORY_ENTRY.date, DATE, true);
    view.setUint32(at + DIRECTORY_ENTRY.crc, crc, true);
    view.setUint32(at + DIRECTORY_ENTRY.packedBytes, bytes.length, true);
    view.setUint32(at + DIRECTORY_ENTRY.unpackedBytes, bytes.length, true);
    view.setUint16(at + DIRECTORY_ENTRY.nameLength, name.length, true);
    view.setUint32(at + DIRECTORY_ENTRY.localHeader, headerAts[i], true);
    zip.set(name, at + DIRECTORY_ENTRY.bytes);
    at += DIRECTORY_ENTRY.bytes + name.length;
  });
  view.setUint32(at, DIRECTORY_END.signature, true);
  view.setUint16(at + DIRECTORY_END.entriesHere, entries.length, true);
  view.setUint16(at + DIRECTORY_END.entries, entries.length, true);
  view.setUint32(at + DIRECTORY_END.directoryBytes, at - directory, true);
  view.setUint32(at + DIRECTORY_END.directory, directory, true);
  return zip;
}
