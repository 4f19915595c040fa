import { crc32 } from '../containers/crc32.ts';
import type { BrickJournal, JournalEntry } from '../formats/bricks/brick-journal.ts';
import type { TemporaryFile } from '../formats/bricks/temporary-files.ts';

// An entry is: bytes of all that follows the CRC-32, bytes of the text, CRC-32 of what follows; the
// text, as JSON, and the arrays that it names by type, first byte and length. All is little-endian.

const HEAD_BYTES = 12;
/** Arrays begin at multiples of this. */
const ALIGNMENT = 8;
const ARRAYS = { Uint16Array, Uint32Array, Float32Array, Float64Array } as const;

/** An array in the text of an entry. */
interface NamedArray {
  readonly array: keyof typeof ARRAYS;
  readonly at: number;
  readonly length: number;
}

/** A journal in a file, of which an entry that was not written to its end is not one. */
export class JournalFile implements BrickJournal {
  readonly #file: Pick<TemporaryFile, 'read' | 'write'>;
  readonly #byteCount: number;
  readonly #flush: () => void;
  #end = 0;

  /**
   * @param byteCount of the file.
   * @param flush makes all that was written last, here and in other files.
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
    // The entry speaks of bytes of other files.
    this.#flush();
    await this.#file.write(bytes, at);
    this.#flush();
  }
}

function bytesOf(entry: JournalEntry): Uint8Array<ArrayBuffer> {
  const arrays: ArrayBufferView[] = [];
  let arrayBytes = 0;
  const text = JSON.stringify(entry, (_, value) => {
    // JSON has neither of these.
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
