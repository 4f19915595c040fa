// Writes zip archives for tests.
import { deflateRawSync } from 'node:zlib';
import { crc32 } from '../io/containers/crc32.ts';

export interface ZipOptions {
  readonly isDeflated?: boolean;
  /** Whether sizes and CRC-32 follow the data of each file, as in archives written as streams. */
  readonly hasDescriptors?: boolean;
  /** Whether sizes and places have 64 bits, as from programs that do not know the total. */
  readonly isZip64?: boolean;
  readonly comment?: string;
}

/** Stands for a number that is in 64 bits elsewhere. */
const MOST = 0xffffffff;

export function zipBytes(
  files: Readonly<Record<string, Uint8Array>>,
  { isDeflated = false, hasDescriptors = false, isZip64 = false, comment = '' }: ZipOptions = {},
): Uint8Array<ArrayBuffer> {
  const archive = new Writer();
  const directory = new Writer();
  const entries = Object.entries(files);
  const encoder = new TextEncoder();
  for (const [path, bytes] of entries) {
    const name = encoder.encode(path);
    const data = isDeflated ? deflateRawSync(bytes) : bytes;
    const crc = crc32(bytes);
    const at = archive.length;
    const putAbout = (to: Writer, isLater: boolean, wide: readonly number[]) => {
      to.u16(isZip64 ? 45 : 20, 0x800 | (hasDescriptors ? 8 : 0), isDeflated ? 8 : 0, 0, 0);
      to.u32(isLater ? 0 : crc);
      for (const size of [data.length, bytes.length]) to.u32(isZip64 ? MOST : isLater ? 0 : size);
      to.u16(name.length, isZip64 ? zip64FieldBytes(wide) : 0);
    };
    const localWide = hasDescriptors ? [0, 0] : [bytes.length, data.length];
    archive.u32(0x04034b50);
    putAbout(archive, hasDescriptors, localWide);
    archive.bytes(name);
    if (isZip64) putZip64Field(archive, localWide);
    archive.bytes(data);
    if (hasDescriptors) {
      archive.u32(0x08074b50, crc);
      if (isZip64) archive.u64(data.length, bytes.length);
      else archive.u32(data.length, bytes.length);
    }
    const wide = [bytes.length, data.length, at];
    directory.u32(0x02014b50);
    directory.u16(20);
    putAbout(directory, false, wide);
    directory.u16(0, 0, 0);
    directory.u32(0, isZip64 ? MOST : at);
    directory.bytes(name);
    if (isZip64) putZip64Field(directory, wide);
  }
  const directoryAt = archive.length;
  archive.bytes(directory.written());
  const count = entries.length;
  if (isZip64) {
    const endAt = archive.length;
    archive.u32(0x06064b50);
    archive.u64(44);
    archive.u16(45, 45);
    archive.u32(0, 0);
    archive.u64(count, count, directory.length, directoryAt);
    archive.u32(0x07064b50, 0);
    archive.u64(endAt);
    archive.u32(1);
  }
  archive.u32(0x06054b50, 0);
  archive.u16(...(isZip64 ? [0xffff, 0xffff] : [count, count]));
  archive.u32(...(isZip64 ? [MOST, MOST] : [directory.length, directoryAt]));
  archive.u16(comment.length);
  archive.bytes(encoder.encode(comment));
  return archive.written();
}

/** Another field that comes before it, which readers have to pass over, included. */
function zip64FieldBytes(numbers: readonly number[]): number {
  return 9 + 4 + 8 * numbers.length;
}

function putZip64Field(to: Writer, numbers: readonly number[]): void {
  to.u16(0x5455, 5);
  to.bytes(Uint8Array.of(1, 0, 0, 0, 0));
  to.u16(1, 8 * numbers.length);
  to.u64(...numbers);
}

class Writer {
  #bytes = new Uint8Array(1 << 16);
  #view = new DataView(this.#bytes.buffer);
  length = 0;

  u16(...values: readonly number[]): void {
    for (const value of values) {
      const at = this.#take(2);
      this.#view.setUint16(at, value, true);
    }
  }

  u32(...values: readonly number[]): void {
    for (const value of values) {
      const at = this.#take(4);
      this.#view.setUint32(at, value, true);
    }
  }

  u64(...values: readonly number[]): void {
    for (const value of values) {
      const at = this.#take(8);
      this.#view.setBigUint64(at, BigInt(value), true);
    }
  }

  bytes(values: Uint8Array): void {
    const at = this.#take(values.length);
    this.#bytes.set(values, at);
  }

  written(): Uint8Array<ArrayBuffer> {
    return this.#bytes.slice(0, this.length);
  }

  /** Room for so many bytes more; returns where it begins. */
  #take(byteCount: number): number {
    const at = this.length;
    this.length += byteCount;
    if (this.length > this.#bytes.length) {
      const larger = new Uint8Array(2 * this.length);
      larger.set(this.#bytes);
      this.#bytes = larger;
      this.#view = new DataView(larger.buffer);
    }
    return at;
  }
}
