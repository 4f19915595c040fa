import { SplatFileError, type SplatFileErrorCode } from '../../../data/errors.ts';
import { shown } from '../../../data/printable.ts';
import { gunzip } from '../../containers/gzip.ts';
import { streamOfBytes } from '../../sources/open-source.ts';
import type { JsonFields } from '../file-json.ts';
import { CHUNK_MAGIC, latin1 } from '../first-bytes.ts';
import { bytesOf, decodeColumn, type Encoding, PROPERTIES, type PropertyName } from './rad-columns.ts';
import { type ChunkPlace, PREFIX_BYTES, padded, parseRadJson } from './rad-header.ts';

const PAYLOAD_LENGTH_BYTES = 8;

interface Property {
  readonly fields: JsonFields;
  readonly encoding: Encoding;
  readonly isPacked: boolean;
  readonly bytes: Uint8Array<ArrayBuffer>;
}

/** Throws if unpacking this many more bytes would exceed the limit. */
export type CheckUnpacked = (byteCount: number) => void;

/** The columns of a chunk, unpacked on request. */
export class RadChunk {
  readonly #properties = new Map<string, Property>();
  readonly #file: string;
  readonly #checkUnpacked: CheckUnpacked;

  /**
   * @param bytes all bytes of the chunk.
   * @param file chunk name in messages.
   * @throws SplatFileError 'bad-header', 'damaged'; 'bad-property' for properties of later versions
   */
  constructor(bytes: Uint8Array<ArrayBuffer>, place: ChunkPlace, file: string, checkUnpacked: CheckUnpacked) {
    this.#file = file;
    this.#checkUnpacked = checkUnpacked;
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
    if (bytes.length < PREFIX_BYTES || latin1(bytes.subarray(0, 4)) !== CHUNK_MAGIC)
      throw this.#error('damaged', `it does not begin with ${CHUNK_MAGIC}.`);
    const length = view.getUint32(4, true);
    const lengthAt = PREFIX_BYTES + padded(length);
    const start = lengthAt + PAYLOAD_LENGTH_BYTES;
    if (start > bytes.length || BigInt(bytes.length - start) !== view.getBigUint64(lengthAt, true))
      throw this.#error('damaged', `it has ${bytes.length} bytes, which its header contradicts.`);
    const json = bytes.subarray(PREFIX_BYTES, PREFIX_BYTES + length);
    const fields = parseRadJson(json, file, 'header of a chunk');
    for (const key of ['base', 'count'] as const) {
      if (fields.count(key) === place[key]) continue;
      throw this.#error('damaged', `its ${key} is ${fields.count(key)}, where the scene says ${place[key]}.`);
    }
    this.#readProperties(fields.list('properties'), bytes.subarray(start));
  }

  has(name: PropertyName): boolean {
    return this.#properties.has(name);
  }

  /**
   * Unpacks and decodes a property: the first values of all rows, then the second values, and so
   * on. `scales` are log scales; `orientation` is x, y, z, w.
   *
   * Rejects with SplatFileError 'damaged', 'bad-header', and as `checkUnpacked`.
   */
  async column(name: PropertyName, count: number): Promise<Float32Array | Uint32Array> {
    const property = this.#properties.get(name);
    if (!property) throw this.#error('damaged', `it has no ${name}.`);
    const { fields, encoding, isPacked, bytes } = property;
    const byteCount = count * bytesOf(name, encoding);
    const unpacked = isPacked ? await this.#unpack(bytes, byteCount) : bytes;
    if (unpacked.length !== byteCount) {
      const message = `its ${name} has other than the ${byteCount} bytes of ${count} rows.`;
      throw this.#error('damaged', message, name);
    }
    return decodeColumn(name, encoding, unpacked, count, (key) => fields.number(key));
  }

  /** Packed properties must be contiguous, as Spark's own reader requires. */
  #readProperties(list: readonly JsonFields[], payload: Uint8Array<ArrayBuffer>): void {
    let end = 0;
    for (const fields of list) {
      const name = fields.get('property');
      if (typeof name !== 'string' || !Object.hasOwn(PROPERTIES, name))
        throw this.#error('bad-property', `it has ${shown(name)}, which is not read.`);
      const encodings: readonly string[] = PROPERTIES[name as PropertyName].encodings;
      const [encoding, compression] = [fields.get('encoding'), fields.get('compression') ?? null];
      if (typeof encoding !== 'string' || !encodings.includes(encoding)) {
        const message = `its ${name} is in ${shown(encoding)}; it is read in ${encodings.join(', ')}.`;
        throw this.#error('bad-property', message, name);
      }
      if (compression !== null && compression !== 'gz') {
        const message = `its ${name} is packed by ${shown(compression)}; gz is read.`;
        throw this.#error('bad-property', message, name);
      }
      const [offset, byteCount] = [fields.count('offset'), fields.count('bytes')];
      // Overlapping properties would let a small file unpack to a large scene.
      if (offset !== end || this.#properties.has(name) || byteCount > payload.length - offset)
        throw this.#error('damaged', `its ${name} is not where it must be.`, name);
      const bytes = payload.subarray(offset, offset + byteCount);
      this.#properties.set(name, {
        ...{ fields, bytes, isPacked: compression !== null },
        encoding: encoding as Encoding,
      });
      end += padded(byteCount);
    }
  }

  /** Unpacks at most `mostBytes` + 1 bytes, into memory that grows as they arrive. */
  async #unpack(packed: Uint8Array<ArrayBuffer>, mostBytes: number): Promise<Uint8Array<ArrayBuffer>> {
    this.#checkUnpacked(mostBytes);
    const stream = streamOfBytes(packed) as ReadableStream<Uint8Array<ArrayBuffer>>;
    const reader = gunzip(stream, this.#file, () => 0, 'deflate-raw').getReader();
    const parts: Uint8Array<ArrayBuffer>[] = [];
    let length = 0;
    while (length <= mostBytes) {
      const { done, value } = await reader.read();
      if (done) break;
      parts.push(value);
      length += value.length;
    }
    // Bytes after the chunk are not needed.
    reader.cancel().catch(() => {});
    const [first] = parts;
    if (parts.length === 1) return first;
    const bytes = new Uint8Array(length);
    let at = 0;
    for (const part of parts) {
      bytes.set(part, at);
      at += part.length;
    }
    return bytes;
  }

  #error(code: SplatFileErrorCode, message: string, property?: string): SplatFileError {
    const place = property === undefined ? {} : { property };
    const advice = code === 'bad-property' ? 'Export it otherwise, or as PLY' : 'Download or export it again';
    return new SplatFileError(code, this.#file, `${message} ${advice}.`, place);
  }
}
