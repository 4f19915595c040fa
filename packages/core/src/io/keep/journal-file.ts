import { crc32 } from '../containers/crc32.ts';
import type { BrickJournal, JournalEntry } from '../formats/bricks/brick-journal.ts';
import type { TemporaryFile } from '../formats/bricks/temporary-files.ts';

// Layout of an entry, little-endian: the number of bytes after the CRC-32; the number of bytes of
// the text; the CRC-32 of the rest. The text as JSON and the arrays follow; the text gives each
// array's type, offset and length.

const HEAD_BYTES = 12;
/** Arrays begin at multiples of this many bytes. */
const ALIGNMENT = 8;
const ARRAYS = { Uint16Array, Uint32Array, Float32Array, Float64Array } as const;

/** Reference to an array, in the JSON of an entry. */
interface NamedArray {
  readonly array: keyof typeof ARRAYS;
  readonly at: number;
  readonly length: number;
}

/** A journal in a file. An incomplete last entry is ignored. */
export class JournalFile implements BrickJournal {
  readonly #file: Pick<TemporaryFile, 'read' | 'write'>;
  readonly #byteCount: number;
  readonly #flush: () => void;
  #end = 0;

  /**
   * @param byteCount current size of the file.
   * @param flush makes earlier writes durable, in this file and in others.
   */
  constructor(file: Pick<TemporaryFile, 'read' | 'write'>, byteCount: number, flush: () => void) {
    this.#file = file;
    this.#byteCount = byteCount;
    this.#flush = flush;
  }

  async *entries(): AsyncGenerator<JournalEntry, void, void> {
    while (this.#end + HEAD_BYTES <= this.#byteCount) {
      const head = new DataView((await this.#file.read(this.#end, HEAD_BYTES)).buffer);
      const [bodyBytes, textBytes, crc] = [0, 4, 8].map((at) => head.getUint32(at, true));
      if (this.#end + HEAD_BYTES + bodyBytes > this.#byteCount) return;
      const body = await this.#file.read(this.#end + HEAD_BYTES, bodyBytes);
      if (crc32(body) !== crc || textBytes > bodyBytes) return;
      this.#end += HEAD_BYTES + bodyBytes;
      yield entryOf(body, textBytes);
    }
  }

  async note(entry: JournalEntry): Promise<void> {
    const bytes = bytesOf(entry);
    const at = this.#end;
    this.#end += bytes.length;
    // The entry refers to bytes of other files, which must be durable first.
    this.#flush();
    await this.#file.write(bytes, at);
    this.#flush();
  }
}

function bytesOf(entry: JournalEntry): Uint8Array<ArrayBuffer> {
  const arrays: ArrayBufferView[] = [];
  let arrayBytes = 0;
  const text = JSON.stringify(entry, (_, value) => {
    // JSON cannot represent −0 and numbers that are not finite.
    if (Object.is(value, -0)) return { number: '-0' };
    if (typeof value === 'number' && !Number.isFinite(value)) return { number: String(value) };
    if (!ArrayBuffer.isView(value)) return value;
    const { length } = value as Float32Array;
    const named = { array: value.constructor.name, at: arrayBytes, length };
    arrays.push(value);
    arrayBytes += aligned(value.byteLength);
    return named;
  });
  const encoded = new TextEncoder().encode(text);
  const firstArray = aligned(encoded.length);
  const bytes = new Uint8Array(HEAD_BYTES + firstArray + arrayBytes);
  bytes.set(encoded, HEAD_BYTES);
  let at = HEAD_BYTES + firstArray;
  for (const { buffer, byteOffset, byteLength } of arrays) {
    bytes.set(new Uint8Array(buffer, byteOffset, byteLength), at);
    at += aligned(byteLength);
  }
  const head = new DataView(bytes.buffer);
  head.setUint32(0, bytes.length - HEAD_BYTES, true);
  head.setUint32(4, encoded.length, true);
  head.setUint32(8, crc32(bytes.subarray(HEAD_BYTES)), true);
  return bytes;
}

function entryOf(body: Uint8Array<ArrayBuffer>, textBytes: number): JournalEntry {
  const firstArray = body.byteOffset + aligned(textBytes);
  return JSON.parse(new TextDecoder().decode(body.subarray(0, textBytes)), (_, value) => {
    if (typeof value?.number === 'string') return Number(value.number);
    if (typeof value?.array !== 'string') return value;
    const { array, at, length } = value as NamedArray;
    const { BYTES_PER_ELEMENT } = ARRAYS[array];
    const start = firstArray + at;
    return new ARRAYS[array](body.buffer.slice(start, start + length * BYTES_PER_ELEMENT));
  });
}

function aligned(byteCount: number): number {
  return Math.ceil(byteCount / ALIGNMENT) * ALIGNMENT;
}
