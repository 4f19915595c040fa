import { type FileFinding, SplatFileError } from '../../data/errors.ts';

const HEADER_BYTES = 12;
const CHUNK_HEADER_BYTES = 8;
/** "glTF", "JSON" and "BIN\0", little-endian. */
const MAGIC = 0x46546c67;
const JSON_CHUNK = 0x4e4f534a;
const BINARY_CHUNK = 0x004e4942;

/** Contents of a binary glTF. */
export interface GlbChunks {
  readonly json: Uint8Array<ArrayBuffer>;
  /** The buffer without a URI. */
  readonly binary?: Uint8Array<ArrayBuffer>;
}

export function isGlb({ buffer, byteOffset, length }: Uint8Array): boolean {
  return length >= 4 && new DataView(buffer, byteOffset).getUint32(0, true) === MAGIC;
}

/**
 * Finds the chunks of a binary glTF 2.0 (.glb). Chunks of other types, and bytes after the length
 * in the header, are ignored.
 *
 * @param bytes the whole file, for which `isGlb` is true.
 * @param file its name in messages.
 * @throws SplatFileError 'truncated', 'damaged'; 'unknown-format' for other versions.
 */
export function unpackGlb(bytes: Uint8Array<ArrayBuffer>, file: string): GlbChunks {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  if (bytes.length < HEADER_BYTES) throw truncated(bytes, file, HEADER_BYTES);
  const version = view.getUint32(4, true);
  if (version !== 2) {
    const finding: FileFinding = [
      `is a binary glTF of version ${version}`,
      'version 2 is read. Export it again as glTF 2.0',
    ];
    throw new SplatFileError('unknown-format', file, finding, { byte: 4 });
  }
  const end = view.getUint32(8, true);
  if (end > bytes.length) throw truncated(bytes, file, end);
  const chunkAt = (at: number, kind: number): Uint8Array<ArrayBuffer> | undefined => {
    if (at + CHUNK_HEADER_BYTES > end || view.getUint32(at + 4, true) !== kind) return undefined;
    const start = at + CHUNK_HEADER_BYTES;
    const length = view.getUint32(at, true);
    if (length <= end - start) return bytes.subarray(start, start + length);
    const message = `a chunk of ${length} bytes goes past the end of the file at byte ${end}. Download or export it again.`;
    throw new SplatFileError('damaged', file, message, { byte: at });
  };
  const json = chunkAt(HEADER_BYTES, JSON_CHUNK);
  if (!json) {
    const message = 'its first chunk is not the JSON that a binary glTF begins with. Export it again.';
    throw new SplatFileError('damaged', file, message, { byte: HEADER_BYTES });
  }
  return { json, binary: chunkAt(HEADER_BYTES + CHUNK_HEADER_BYTES + json.length, BINARY_CHUNK) };
}

function truncated({ length }: Uint8Array, file: string, neededBytes: number): SplatFileError {
  const message = `it must have ${neededBytes} bytes and has ${length}. Download or export it again.`;
  return new SplatFileError('truncated', file, message, { byte: length });
}

/**
 * Begins a binary glTF 2.0: writes header and JSON, and leaves the binary chunk to the caller. The
 * chunk begins at a multiple of 4 bytes.
 *
 * @param memoryOf allocates zero-filled memory for the file.
 */
export function beginGlb(
  json: object,
  binaryBytes: number,
  memoryOf: (byteCount: number) => Uint8Array<ArrayBuffer>,
): { readonly bytes: Uint8Array<ArrayBuffer>; readonly binary: Uint8Array<ArrayBuffer> } {
  const padded = (byteCount: number) => 4 * Math.ceil(byteCount / 4);
  const text = new TextEncoder().encode(JSON.stringify(json));
  const jsonStart = HEADER_BYTES + CHUNK_HEADER_BYTES;
  const binaryStart = jsonStart + padded(text.length) + CHUNK_HEADER_BYTES;
  const bytes = memoryOf(binaryStart + padded(binaryBytes));
  const view = new DataView(bytes.buffer);
  const putWords = (at: number, words: readonly number[]) =>
    words.forEach((word, i) => {
      view.setUint32(at + 4 * i, word, true);
    });
  putWords(0, [MAGIC, 2, bytes.length, padded(text.length), JSON_CHUNK]);
  // JSON is padded with spaces.
  bytes.fill(0x20, jsonStart, jsonStart + padded(text.length)).set(text, jsonStart);
  putWords(binaryStart - CHUNK_HEADER_BYTES, [padded(binaryBytes), BINARY_CHUNK]);
  return { bytes, binary: bytes.subarray(binaryStart, binaryStart + binaryBytes) };
}
