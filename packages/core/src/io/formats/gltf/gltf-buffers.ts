import { CodeUnavailableError, type SplatFileError } from '../../../data/errors.ts';
import { shown } from '../../../data/printable.ts';
import { ByteReader } from '../../sources/byte-reader.ts';
import { streamOfBytes } from '../../sources/open-source.ts';
import { unpackedLimit } from '../../sources/read-limits.ts';
import { readPart } from '../../sources/read-part.ts';
import type { SplatFormatOptions, SplatInput } from '../read-format.ts';
import type { ReadProgress } from '../rows/progress.ts';
import { type GltfJson, type JsonObject, objectOf } from './gltf-json.ts';
import { meshoptOf, packedViewOf } from './packed-view.ts';

/** Longest accepted URI: enough for any name, and for most URL signatures. */
const LONGEST_PATH = 1000;

/** The bytes of a bufferView. */
export interface BufferView {
  readonly bytes: Uint8Array<ArrayBuffer>;
  /** Bytes from one element to the next; undefined if elements are contiguous. */
  readonly strideBytes: number | undefined;
}

/** The buffers of a glTF, each read on first use. */
export class GltfBuffers {
  readonly #json: GltfJson;
  readonly #binary: Uint8Array<ArrayBuffer> | undefined;
  readonly #input: SplatInput;
  readonly #options: SplatFormatOptions;
  readonly #progress: ReadProgress;
  readonly #buffers = new Map<number, Uint8Array<ArrayBuffer>>();
  readonly #files = new Map<string, Uint8Array<ArrayBuffer>>();
  readonly #unpacked = new Map<JsonObject, BufferView>();
  #byteCount = 0;
  #unpackedBytes = 0;

  /** @param binary the buffer without a URI, in a .glb; undefined if there is none. */
  constructor(
    json: GltfJson,
    binary: Uint8Array<ArrayBuffer> | undefined,
    input: SplatInput,
    options: SplatFormatOptions,
    progress: ReadProgress,
  ) {
    this.#json = json;
    this.#binary = binary;
    this.#input = input;
    this.#options = options;
    this.#progress = progress;
  }

  /** Bytes of all buffers used so far. */
  get byteCount(): number {
    return this.#byteCount;
  }

  /** Bytes of meshopt-compressed bufferViews after unpacking. */
  get unpackedBytes(): number {
    return this.#unpackedBytes;
  }

  /** Limit of unpacked bytes, in proportion to the bytes of buffers. */
  get mostUnpackedBytes(): number {
    return unpackedLimit(this.#options, { totalBytes: this.#byteCount });
  }

  /**
   * Reads a bufferView, and decompresses it if it uses meshopt.
   *
   * Rejects with SplatFileError 'bad-header', 'bad-property', 'damaged', 'truncated', 'too-large';
   * as `readPart`, and as `DecodeMeshopt`.
   */
  async view(index: unknown, user: string): Promise<BufferView> {
    const json = this.#json;
    const view = json.entryOf('bufferViews', index, user);
    const element = `bufferViews[${index}]`;
    const packed = meshoptOf(view);
    if (packed) return this.#unpack(view, packed, element);
    const strideBytes = view.byteStride === undefined ? undefined : json.countOf(view, 'byteStride', element);
    return { bytes: await this.#part(view, element), strideBytes };
  }

  /** A byte range of a buffer. @param place object with `buffer`, `byteOffset` and `byteLength`. */
  async #part(place: JsonObject, element: string): Promise<Uint8Array<ArrayBuffer>> {
    const json = this.#json;
    const start = json.countOf(place, 'byteOffset', element, 0);
    const length = json.countOf(place, 'byteLength', element);
    const buffer = await this.#buffer(place, element);
    if (length <= buffer.length - start) return buffer.subarray(start, start + length);
    const message = `${element} has bytes ${start} to ${start + length} of a buffer of ${buffer.length}. Export it again.`;
    throw json.error('damaged', message, { element });
  }

  /** Decompresses a view once; attributes may share it. */
  async #unpack(view: JsonObject, packed: JsonObject, element: string): Promise<BufferView> {
    const known = this.#unpacked.get(view);
    if (known) return known;
    const json = this.#json;
    const about = packedViewOf(json, view, packed, element);
    const { count, strideBytes, mode } = about;
    const bytes = await this.#part(packed, element);
    this.#unpackedBytes += count * strideBytes;
    if (this.#unpackedBytes > this.mostUnpackedBytes) {
      const message = `its bufferViews unpack to ${this.#unpackedBytes} bytes or more, out of ${this.#byteCount}. Pass a larger maxBytes if that is right.`;
      throw json.error('too-large', message, { element });
    }
    const { decodeMeshopt, signal } = this.#options;
    if (!decodeMeshopt) {
      const cause = new Error('these readers have none');
      throw new CodeUnavailableError('decoder of meshopt', { cause });
    }
    // Copied, because a worker transfers it to its page.
    const unpacked = await decodeMeshopt({ ...about, bytes: bytes.slice() });
    signal?.throwIfAborted();
    if (!unpacked)
      throw json.error('damaged', `${element} cannot be unpacked by meshopt. Download or export it again.`, {
        element,
      });
    const result = { bytes: unpacked, strideBytes: mode === 'ATTRIBUTES' ? strideBytes : undefined };
    this.#unpacked.set(view, result);
    return result;
  }

  /**
   * Reads a bufferView as an embedded file, with `read`.
   *
   * Rejects as `view` and `read` do.
   *
   * @param user referring element, and name of the file in messages.
   */
  async readView<Result>(
    index: unknown,
    user: string,
    read: (input: SplatInput, options: SplatFormatOptions) => Promise<Result>,
  ): Promise<Result> {
    const { bytes } = await this.view(index, user);
    const name = `${this.#input.name}, ${user}`;
    const reader = new ByteReader({ name, stream: streamOfBytes(bytes) }, this.#options.signal);
    try {
      const size = { totalBytes: bytes.length, totalBytesCertain: true, isLocal: true };
      return await read({ name, ...size, reader }, this.#options);
    } finally {
      reader.close();
    }
  }

  async #buffer(view: JsonObject, user: string): Promise<Uint8Array<ArrayBuffer>> {
    const json = this.#json;
    const buffer = json.entryOf('buffers', view.buffer, user);
    const index = view.buffer as number;
    const known = this.#buffers.get(index);
    if (known) return known;
    const element = `buffers[${index}]`;
    const length = json.countOf(buffer, 'byteLength', element);
    const bytes = await this.#load(buffer.uri, index, element, view);
    if (bytes.length < length) {
      const message = `${element} must have ${length} bytes and has ${bytes.length}. Download or export it again.`;
      throw json.error(isFile(buffer.uri) ? 'truncated' : 'damaged', message, { element });
    }
    const used = bytes.subarray(0, length);
    this.#buffers.set(index, used);
    return used;
  }

  async #load(
    uri: unknown,
    index: number,
    element: string,
    view: JsonObject,
  ): Promise<Uint8Array<ArrayBuffer>> {
    if (uri === undefined && index === 0 && this.#binary) return this.#count(aligned(this.#binary));
    if (typeof uri !== 'string') {
      const packedBy = Object.keys(objectOf(view.extensions)).join(', ');
      const why = packedBy
        ? `it is packed by ${shown(packedBy)}, which is not read; export it without`
        : 'it has no address, and there is no binary chunk for it; export it again';
      throw this.#json.error('damaged', `${element} has no bytes: ${why}.`, { element });
    }
    if (isDataUri(uri)) {
      const bytes = decodeDataUri(uri);
      if (bytes) return this.#count(bytes);
      throw this.#json.error('damaged', `the data: URI of ${element} is no base64. Export it again.`, {
        element,
      });
    }
    if (uri.length > LONGEST_PATH) {
      const message = `the address of ${element} is ${shown(uri)}, no valid one.`;
      throw this.#json.error('bad-header', message, { element, property: 'uri' });
    }
    const known = this.#files.get(uri);
    if (known) return known;
    if (this.#files.size === 0) this.#progress.expectParts(this.#fileCount());
    const bytes = await this.#readFile(uri);
    this.#files.set(uri, bytes);
    return this.#count(bytes);
  }

  /**
   * Number of separate buffer files. Buffers of other geometry may stay unread, so the total size
   * stays unknown.
   */
  #fileCount(): number {
    const uris = this.#json.listOf(this.#json.root, 'buffers').map((buffer) => objectOf(buffer).uri);
    return new Set(uris.filter(isFile)).size;
  }

  #count(bytes: Uint8Array<ArrayBuffer>): Uint8Array<ArrayBuffer> {
    this.#byteCount += bytes.length;
    return bytes;
  }

  /** Reads a file by its URI. Some exporters write the plain name instead, so it is tried first. */
  async #readFile(uri: string): Promise<Uint8Array<ArrayBuffer>> {
    const { maxBytes: most } = this.#options;
    const options = { ...this.#options, maxBytes: most && Math.max(1, most - this.#byteCount) };
    const read = (path: string) =>
      readPart(this.#input, path, options, (size) => this.#progress.beginPart(size));
    // Servers decode addresses themselves.
    if (this.#input.fetched) return read(uri.replace(/%(?![\da-f]{2})/gi, '%25'));
    return read(uri).catch((error: SplatFileError) => {
      if (error.code !== 'missing-part') throw error;
      return read(pathOf(uri));
    });
  }
}

/** The path of a URI: percent-decoded, but for slashes in names; the text itself if it is not UTF-8. */
function pathOf(uri: string): string {
  try {
    return uri.replace(/(%(?!2f)[\da-f]{2})+/gi, (encoded) => decodeURIComponent(encoded));
  } catch {
    // A file of that name may still be there; the reader of a missing one reports it.
    return uri;
  }
}

/**
 * Copies bytes if they are unaligned, as typed arrays require: writers may forget to pad the JSON
 * of a .glb.
 */
function aligned(bytes: Uint8Array<ArrayBuffer>): Uint8Array<ArrayBuffer> {
  return bytes.byteOffset % 4 === 0 ? bytes : bytes.slice();
}

function isFile(uri: unknown): boolean {
  return typeof uri === 'string' && !isDataUri(uri);
}

/** Value of each base64 character, by its code; 255 for other characters. */
const VALUES = new Uint8Array(128).fill(255);
for (const [value, character] of [
  ...'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/',
].entries()) {
  VALUES[character.charCodeAt(0)] = value;
}

export function isDataUri(uri: string): boolean {
  return /^data:/i.test(uri);
}

/**
 * Decodes a base64 data: URI (RFC 2397). A content security policy may forbid to fetch one.
 *
 * @returns null for any other URI.
 */
export function decodeDataUri(uri: string): Uint8Array<ArrayBuffer> | null {
  // Only the beginning is searched: the rest may be megabytes.
  const start = /^data:[^,]{0,200};base64,/i.exec(uri.slice(0, 300))?.[0].length;
  if (start === undefined) return null;
  let end = uri.length;
  while (end > start && end > uri.length - 2 && uri.charCodeAt(end - 1) === 0x3d) end--;
  const length = end - start;
  if (length % 4 === 1) return null;
  const bytes = new Uint8Array(Math.floor((length * 3) / 4));
  let at = 0;
  let bits = 0;
  let isValid = true;
  for (let i = 0; i < length; i++) {
    const code = uri.charCodeAt(start + i);
    const value = code < 128 ? VALUES[code] : 255;
    if (value === 255) isValid = false;
    bits = (bits << 6) | value;
    if (i % 4 !== 0) bytes[at++] = bits >> (6 - 2 * (i % 4));
  }
  return isValid ? bytes : null;
}
