// Writes zip archives for tests.
import { deflateRawSync } from 'node:zlib';
import { crc32 } from '../io/containers/crc32.ts';

export interface ZipOptions {
  readonly isDeflated?: boolean;
  /** Whether sizes and CRC-32 follow the data of each file, as in archives that were written as streams. */
  readonly hasDescriptors?: boolean;
  readonly comment?: string;
}

export function zipBytes(
  files: Readonly<Record<string, Uint8Array>>,
  { isDeflated = false, hasDescriptors = false, comment = '' }: ZipOptions = {},
): Uint8Array<ArrayBuffer> {
  const parts: Uint8Array[] = [];
  const directory: Uint8Array[] = [];
  let length = 0;
  const push = (part: Uint8Array) => {
    parts.push(part);
    length += part.length;
  };
  for (const [path, bytes] of Object.entries(files)) {
    const name = new TextEncoder().encode(path);
    const data = isDeflated ? deflateRawSync(bytes) : bytes;
    const at = length;
    const flags = 0x800 | (hasDescriptors ? 8 : 0);
    const about = (isLocal: boolean) => {
      const isLater = isLocal && hasDescriptors;
      return [
        ...[u16(20), u16(flags), u16(isDeflated ? 8 : 0), u32(0)],
        ...[u32(isLater ? 0 : crc32(bytes)), u32(isLater ? 0 : data.length), u32(isLater ? 0 : bytes.length)],
        ...[u16(name.length), u16(0)],
      ];
    };
    for (const part of [u32(0x04034b50), ...about(true), name, data]) push(part);
    if (hasDescriptors)
      for (const part of [u32(0x08074b50), u32(crc32(bytes)), u32(data.length), u32(bytes.length)])
        push(part);
    directory.push(u32(0x02014b50), u16(20), ...about(false), u16(0), u16(0), u16(0), u32(0), u32(at), name);
  }
  const directoryAt = length;
  for (const part of directory) push(part);
  const directoryBytes = length - directoryAt;
  const count = Object.keys(files).length;
  for (const part of [u32(0x06054b50), u32(0), u16(count), u16(count), u32(directoryBytes), u32(directoryAt)])
    push(part);
  push(u16(comment.length));
  push(new TextEncoder().encode(comment));
  return Uint8Array.from(Buffer.concat(parts));
}

function u16(value: number): Uint8Array {
  return Uint8Array.of(value & 255, value >> 8);
}

function u32(value: number): Uint8Array {
  return Uint8Array.of(value & 255, (value >>> 8) & 255, (value >>> 16) & 255, value >>> 24);
}
