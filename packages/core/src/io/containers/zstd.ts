import { type FilePlace, SplatFileError } from '../../data/errors.ts';
import {
  backwardBits,
  constantFseTable,
  type FseTable,
  fseTable,
  readFseTable,
  ZstdDamage,
} from './zstd-fse.ts';
import { decodeHuffman, type HuffmanTable, readHuffmanTable } from './zstd-huffman.ts';

const FRAME_MAGIC = 0xfd2fb528;
/** Magic number of skippable frames; its lowest four bits are arbitrary. */
const SKIPPED_MAGIC = 0x184d2a50;
/** Most unpacked bytes of a block. */
const BLOCK_BYTES = 1 << 17;
/** Copies of at least this many bytes use the engine's built-in functions. */
const LONG_COPY = 64;

const MOST_BITS_AT_ONCE = 25;

/** One of the three values of a sequence: the coding of its codes, and their meaning. */
interface Field {
  readonly maxLog: number;
  readonly maxSymbol: number;
  /** The predefined code. */
  readonly usual: FseTable;
}

const LITERALS: Field = {
  maxLog: 9,
  maxSymbol: 35,
  usual: fseTable(
    [
      ...[4, 3, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 1, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2, 2, 3, 2, 1],
      ...[1, 1, 1, 1, -1, -1, -1, -1],
    ],
    6,
  ),
};
const OFFSETS: Field = {
  maxLog: 8,
  maxSymbol: 31,
  usual: fseTable(
    [1, 1, 1, 1, 1, 1, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, -1, -1, -1, -1, -1],
    5,
  ),
};
const MATCHES: Field = {
  maxLog: 9,
  maxSymbol: 52,
  usual: fseTable(
    [
      ...[1, 4, 3, 2, 2, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1],
      ...[1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, -1, -1, -1, -1, -1, -1, -1],
    ],
    6,
  ),
};

/** Extra bits of each literal length code, and its base length. */
const LITERAL_BITS = Uint8Array.from([...Array(16).fill(0), 1, 1, 1, 1, 2, 2, 3, 3, 4, ...countFrom(6, 16)]);
const LITERAL_BASES = basesOf(LITERAL_BITS, 0);
const MATCH_BITS = Uint8Array.from([
  ...Array(32).fill(0),
  1,
  1,
  1,
  1,
  2,
  2,
  3,
  3,
  4,
  4,
  5,
  ...countFrom(7, 16),
]);
const MATCH_BASES = basesOf(MATCH_BITS, 3);

function countFrom(first: number, last: number): number[] {
  return Array.from({ length: last - first + 1 }, (_, i) => first + i);
}

function basesOf(bits: Uint8Array, first: number): Int32Array {
  let base = first;
  return Int32Array.from(bits, (count) => {
    base += 1 << count;
    return base - (1 << count);
  });
}

/**
 * Unpacks Zstandard data (RFC 8878) of known unpacked length. Memory is bounded by that length, and
 * time by both lengths, even for malicious data: 22 bytes can make a naive decoder run for ever.
 * Dictionaries are not supported; checksums are ignored.
 *
 * @param length unpacked length, in bytes.
 * @param file its name in messages.
 * @throws SplatFileError 'damaged', or 'too-large' if memory is exhausted.
 */
export function unpackZstd(
  packed: Uint8Array,
  length: number,
  file: string,
  place: FilePlace = {},
): Uint8Array<ArrayBuffer> {
  try {
    return new ZstdUnpacking(packed, length).run();
  } catch (cause) {
    if (cause instanceof RangeError) {
      const message = `no memory for the ${length} bytes that it unpacks to. Read a smaller scene.`;
      throw new SplatFileError('too-large', file, message, place, { cause });
    }
    if (!(cause instanceof ZstdDamage)) throw cause;
    const message = `it cannot be unpacked: ${cause.message}. Download or export it again.`;
    throw new SplatFileError('damaged', file, message, place, { cause });
  }
}

class ZstdUnpacking {
  readonly #bytes: Uint8Array;
  readonly #out: Uint8Array<ArrayBuffer>;
  /** Offset of the next input byte, and of the next output byte. */
  #at = 0;
  #outAt = 0;
  /** Output offset of the current frame, then state that carries over between its blocks. */
  #frameStart = 0;
  #huffman: HuffmanTable | null = null;
  #tables: (FseTable | null)[] = [];
  readonly #recentOffsets = new Int32Array(3);
  /** Reused buffer for the unpacked literals of a block; null before its first use. */
  #unpackedLiterals: Uint8Array | null = null;
  #literals: Uint8Array;
  #literalsAt = 0;
  #literalsEnd = 0;

  constructor(bytes: Uint8Array, length: number) {
    this.#bytes = bytes;
    this.#literals = bytes;
    this.#out = new Uint8Array(length);
  }

  run(): Uint8Array<ArrayBuffer> {
    while (this.#at < this.#bytes.length) {
      const magic = this.#number(4);
      if (magic === FRAME_MAGIC) this.#frame();
      else if ((magic & ~15) >>> 0 === SKIPPED_MAGIC) this.#skip(this.#number(4));
      else throw new ZstdDamage('it does not begin as zstd data does');
    }
    if (this.#outAt !== this.#out.length)
      throw new ZstdDamage(`it holds ${this.#outAt} bytes instead of ${this.#out.length}`);
    return this.#out;
  }

  /** Skips bytes and returns the offset of the first. */
  #skip(count: number): number {
    const start = this.#at;
    if (count > this.#bytes.length - start) throw new ZstdDamage('it ends too early');
    this.#at = start + count;
    return start;
  }

  #number(byteCount: number): number {
    const start = this.#skip(byteCount);
    let value = 0;
    for (let i = byteCount - 1; i >= 0; i--) value = 256 * value + this.#bytes[start + i];
    return value;
  }

  #frame(): void {
    const flags = this.#number(1);
    const isSingleSegment = (flags & 0x20) !== 0;
    if (flags & 8) throw new ZstdDamage('a frame is of an unknown kind');
    // The window size is irrelevant, because the whole output is kept.
    if (!isSingleSegment) this.#skip(1);
    if (this.#number([0, 1, 2, 4][flags & 3]) !== 0) throw new ZstdDamage('it needs a dictionary');
    const sizeBytes = [isSingleSegment ? 1 : 0, 2, 4, 8][flags >> 6];
    const size = this.#number(sizeBytes) + (sizeBytes === 2 ? 256 : 0);
    if (sizeBytes > 0 && size > this.#out.length - this.#outAt)
      throw new ZstdDamage(`it holds more than ${this.#out.length} bytes`);
    this.#frameStart = this.#outAt;
    this.#huffman = null;
    this.#tables = [null, null, null];
    this.#recentOffsets.set([1, 4, 8]);
    while (!this.#block());
    if (sizeBytes > 0 && this.#outAt - this.#frameStart !== size)
      throw new ZstdDamage(`a frame does not hold the ${size} bytes that it promises`);
    if (flags & 4) this.#skip(4);
  }

  /** Unpacks a block. Returns whether it is the last of the frame. */
  #block(): boolean {
    const head = this.#number(3);
    const size = head >> 3;
    if (size > BLOCK_BYTES) throw new ZstdDamage(`a block has ${size} bytes`);
    switch ((head >> 1) & 3) {
      case 0: {
        const start = this.#skip(size);
        this.#out.set(this.#bytes.subarray(start, start + size), this.#grow(size));
        break;
      }
      case 1: {
        const byte = this.#number(1);
        const start = this.#grow(size);
        this.#out.fill(byte, start, start + size);
        break;
      }
      case 2: {
        const start = this.#skip(size);
        this.#sequences(this.#readLiterals(start, start + size), start + size);
        break;
      }
      default:
        throw new ZstdDamage('a block is of an unknown kind');
    }
    return (head & 1) !== 0;
  }

  /** Reserves output bytes and returns the offset of the first. */
  #grow(count: number): number {
    const start = this.#outAt;
    if (count > this.#out.length - start)
      throw new ZstdDamage(`it holds more than ${this.#out.length} bytes`);
    this.#outAt = start + count;
    return start;
  }

  /** Finds the literals of the block in bytes `start` to `end`; returns the offset of its sequences. */
  #readLiterals(start: number, end: number): number {
    const bytes = this.#bytes;
    const kind = bytes[start] & 3;
    const sizeFormat = (bytes[start] >> 2) & 3;
    const isPlain = kind < 2;
    const headBytes = isPlain ? [1, 2, 1, 3][sizeFormat] : [3, 3, 4, 5][sizeFormat];
    if (headBytes > end - start) throw new ZstdDamage('a block ends too early');
    let head = 0;
    for (let i = headBytes - 1; i >= 0; i--) head = 256 * head + bytes[start + i];
    const sizeBits = isPlain ? [5, 12, 5, 20][sizeFormat] : [10, 10, 14, 18][sizeFormat];
    const sizes = Math.floor(head / (isPlain && sizeBits === 5 ? 8 : 16));
    const size = sizes % 2 ** sizeBits;
    const body = start + headBytes;
    const packedSize = kind === 0 ? size : kind === 1 ? 1 : Math.floor(sizes / 2 ** sizeBits);
    const bodyEnd = body + packedSize;
    if (size > BLOCK_BYTES || bodyEnd > end) throw new ZstdDamage('the literals of a block have no end');
    if (kind === 0) {
      this.#literals = bytes;
      this.#literalsAt = body;
      this.#literalsEnd = bodyEnd;
      return bodyEnd;
    }
    this.#unpackedLiterals ??= new Uint8Array(BLOCK_BYTES);
    this.#literals = this.#unpackedLiterals;
    this.#literalsAt = 0;
    this.#literalsEnd = size;
    if (kind === 1) this.#literals.fill(bytes[body], 0, size);
    else this.#unpackLiterals(body, bodyEnd, size, kind === 2, sizeFormat === 0);
    return bodyEnd;
  }

  #unpackLiterals(start: number, end: number, size: number, isNewCode: boolean, isOneStream: boolean): void {
    const bytes = this.#bytes;
    let at = start;
    if (isNewCode) {
      const { table, end: codeEnd } = readHuffmanTable(bytes, start, end);
      this.#huffman = table;
      at = codeEnd;
    }
    const huffman = this.#huffman;
    if (!huffman) throw new ZstdDamage('a block has no Huffman code');
    const into = this.#literals;
    if (isOneStream) {
      decodeHuffman(bytes, at, end, huffman, into, 0, size);
      return;
    }
    const part = (size + 3) >> 2;
    let from = at + 6;
    if (from > end || 3 * part > size)
      throw new ZstdDamage('a block has not the four streams that it promises');
    for (let stream = 0; stream < 4; stream++, at += 2) {
      const to = stream < 3 ? from + bytes[at] + 256 * bytes[at + 1] : end;
      if (to > end) throw new ZstdDamage('a Huffman stream has no end');
      decodeHuffman(bytes, from, to, huffman, into, stream * part, stream < 3 ? (stream + 1) * part : size);
      from = to;
    }
  }

  /** Executes the sequences in bytes `start` to `end` of the current block. */
  #sequences(start: number, end: number): void {
    const bytes = this.#bytes;
    const byteAt = (at: number) => {
      if (at >= end) throw new ZstdDamage('a block has no sequences');
      return bytes[at];
    };
    let at = start;
    let count = byteAt(at++);
    if (count === 255) {
      count = byteAt(at) + 256 * byteAt(at + 1) + 0x7f00;
      at += 2;
    } else if (count > 127) count = 256 * (count - 128) + byteAt(at++);
    if (count > 0) {
      const kinds = byteAt(at++);
      if (kinds & 3) throw new ZstdDamage('the sequences of a block are of an unknown kind');
      for (const [i, field] of [LITERALS, OFFSETS, MATCHES].entries()) {
        const kind = (kinds >> (6 - 2 * i)) & 3;
        if (kind === 0) this.#tables[i] = field.usual;
        else if (kind === 1) {
          const symbol = byteAt(at++);
          if (symbol > field.maxSymbol) throw new ZstdDamage(`a sequence has code ${symbol}`);
          this.#tables[i] = constantFseTable(symbol);
        } else if (kind === 2) {
          const { table, end: tableEnd } = readFseTable(bytes, at, end, field);
          this.#tables[i] = table;
          at = tableEnd;
        } else if (!this.#tables[i]) throw new ZstdDamage('a block takes a table that was not there before');
      }
      const [literals, offsets, matches] = this.#tables as FseTable[];
      this.#runSequences(count, at, end, literals, offsets, matches);
    } else if (at !== end) throw new ZstdDamage('there are bytes after the end of a block');
    this.#copyLiterals(this.#literalsEnd - this.#literalsAt, this.#out.length);
  }

  #copyLiterals(count: number, limit: number): void {
    const start = this.#outAt;
    if (count > limit - start) throw new ZstdDamage('a block holds more bytes than it may');
    this.#out.set(this.#literals.subarray(this.#literalsAt, this.#literalsAt + count), start);
    this.#literalsAt += count;
    this.#outAt = start + count;
  }

  #runSequences(
    count: number,
    start: number,
    end: number,
    { log: literalsLog, symbols: literalCodes, bits: literalsBits, bases: literalsBases }: FseTable,
    { log: offsetsLog, symbols: offsetCodes, bits: offsetsBits, bases: offsetsBases }: FseTable,
    { log: matchesLog, symbols: matchCodes, bits: matchesBits, bases: matchesBases }: FseTable,
  ): void {
    const bytes = this.#bytes;
    const out = this.#out;
    const literals = this.#literals;
    const literalsEnd = this.#literalsEnd;
    const frameStart = this.#frameStart;
    const outEnd = Math.min(out.length, this.#outAt + BLOCK_BYTES);
    let literalsAt = this.#literalsAt;
    let outAt = this.#outAt;
    let [recent0, recent1, recent2] = this.#recentOffsets;
    let left = backwardBits(bytes, start, end);

    left -= literalsLog;
    let literalsState = bitsAt(bytes, start, left, literalsLog);
    left -= offsetsLog;
    let offsetsState = bitsAt(bytes, start, left, offsetsLog);
    left -= matchesLog;
    let matchesState = bitsAt(bytes, start, left, matchesLog);
    for (let i = 0; i < count; i++) {
      let offsetBits = offsetCodes[offsetsState];
      let offsetValue = 1 << offsetBits;
      if (offsetBits > MOST_BITS_AT_ONCE) {
        // Larger offsets exceed the output anyway.
        if (offsetBits > 30) throw new ZstdDamage('a sequence refers to what is not there');
        offsetBits -= 16;
        left -= offsetBits;
        offsetValue += bitsAt(bytes, start, left, offsetBits) << 16;
        offsetBits = 16;
      }
      left -= offsetBits;
      offsetValue += bitsAt(bytes, start, left, offsetBits);
      const matchCode = matchCodes[matchesState];
      left -= MATCH_BITS[matchCode];
      let matchLength = MATCH_BASES[matchCode] + bitsAt(bytes, start, left, MATCH_BITS[matchCode]);
      const literalCode = literalCodes[literalsState];
      left -= LITERAL_BITS[literalCode];
      let literalCount = LITERAL_BASES[literalCode] + bitsAt(bytes, start, left, LITERAL_BITS[literalCode]);
      if (i < count - 1) {
        left -= literalsBits[literalsState];
        literalsState =
          literalsBases[literalsState] + bitsAt(bytes, start, left, literalsBits[literalsState]);
        left -= matchesBits[matchesState];
        matchesState = matchesBases[matchesState] + bitsAt(bytes, start, left, matchesBits[matchesState]);
        left -= offsetsBits[offsetsState];
        offsetsState = offsetsBases[offsetsState] + bitsAt(bytes, start, left, offsetsBits[offsetsState]);
      }
      if (left < 0) throw new ZstdDamage('the sequences of a block end too early');

      // Small offset values are indices of the three last offsets, shifted by one if there are no
      // literals.
      const place = offsetValue + (literalCount === 0 ? 1 : 0);
      let offset: number;
      if (offsetValue > 3) offset = offsetValue - 3;
      else if (place === 1) offset = recent0;
      else if (place === 2) offset = recent1;
      else if (place === 3) offset = recent2;
      else offset = recent0 - 1;
      if (offsetValue > 3 || place > 2) recent2 = recent1;
      if (offsetValue > 3 || place > 1) recent1 = recent0;
      recent0 = offset;

      if (literalCount > literalsEnd - literalsAt || literalCount + matchLength > outEnd - outAt)
        throw new ZstdDamage('a sequence holds more bytes than it may');
      if (offset < 1 || offset > outAt + literalCount - frameStart)
        throw new ZstdDamage('a sequence refers to what is not there');
      if (literalCount >= LONG_COPY) {
        out.set(literals.subarray(literalsAt, literalsAt + literalCount), outAt);
        literalsAt += literalCount;
        outAt += literalCount;
      } else for (; literalCount > 0; literalCount--) out[outAt++] = literals[literalsAt++];
      let from = outAt - offset;
      if (matchLength >= LONG_COPY && offset >= matchLength) {
        out.copyWithin(outAt, from, from + matchLength);
        outAt += matchLength;
      } else for (; matchLength > 0; matchLength--) out[outAt++] = out[from++];
    }
    if (left !== 0) throw new ZstdDamage('there are bits after the sequences of a block');
    this.#recentOffsets.set([recent0, recent1, recent2]);
    this.#literalsAt = literalsAt;
    this.#outAt = outAt;
  }
}

/**
 * Up to `MOST_BITS_AT_ONCE` bits, from bit `from` after byte `start`; bits before `start` are
 * arbitrary.
 */
function bitsAt(bytes: Uint8Array, start: number, from: number, count: number): number {
  const at = start + (from >> 3);
  const word =
    (bytes[at] | (bytes[at + 1] << 8) | (bytes[at + 2] << 16) | (bytes[at + 3] << 24)) >>> (from & 7);
  return word & ((1 << count) - 1);
}
