import { backwardBits, readFseTable, ZstdDamage } from './zstd-fse.ts';

/** A Huffman code of bytes (RFC 8878, section 4.2): look-up by the next `maxBits` bits. */
export interface HuffmanTable {
  readonly maxBits: number;
  /** Low 8 bits: the decoded byte. Bits from 8 on: the number of bits of its code. */
  readonly entries: Uint16Array;
}

const MOST_BITS = 11;
const MOST_WEIGHTS = 255;

/** Reads a code description from byte `start`, up to byte `limit`. */
export function readHuffmanTable(
  bytes: Uint8Array,
  start: number,
  limit: number,
): { readonly table: HuffmanTable; readonly end: number } {
  const head = start < limit ? bytes[start] : 0;
  const isPlain = head >= 128;
  const end = start + 1 + (isPlain ? (head - 126) >> 1 : head);
  if (end > limit) throw new ZstdDamage('a Huffman code has no end');
  const weights = isPlain ? plainWeights(bytes, start + 1, head - 127) : packedWeights(bytes, start + 1, end);
  return { table: huffmanTable(weights), end };
}

function plainWeights(bytes: Uint8Array, start: number, count: number): number[] {
  return Array.from({ length: count }, (_, i) => (bytes[start + (i >> 1)] >> (i & 1 ? 0 : 4)) & 15);
}

/** Weights from two interleaved finite state entropy states, until the bits end. */
function packedWeights(bytes: Uint8Array, start: number, end: number): number[] {
  const { table, end: from } = readFseTable(bytes, start, end, { maxLog: 6, maxSymbol: MOST_BITS });
  const { log, symbols, bits, bases } = table;
  let left = backwardBits(bytes, from, end);
  const read = (count: number) => {
    left -= count;
    const at = from + (left >> 3);
    return (((bytes[at] ?? 0) | ((bytes[at + 1] ?? 0) << 8)) >> (left & 7)) & ((1 << count) - 1);
  };
  if (left < 2 * log) throw new ZstdDamage('a Huffman code has no weights');
  const states = [read(log), read(log)];
  const weights: number[] = [];
  for (let turn = 0; ; turn ^= 1) {
    weights.push(symbols[states[turn]]);
    if (weights.length > MOST_WEIGHTS) throw new ZstdDamage('a Huffman code has too many weights');
    const needed = bits[states[turn]];
    if (needed > left) {
      weights.push(symbols[states[turn ^ 1]]);
      return weights;
    }
    states[turn] = bases[states[turn]] + read(needed);
  }
}

/** @param weights of each byte except the last used one: weight w has 2^(w - 1) entries. */
function huffmanTable(weights: number[]): HuffmanTable {
  let sum = 0;
  for (const weight of weights) {
    if (weight > MOST_BITS) throw new ZstdDamage(`a Huffman code has weight ${weight}`);
    sum += (1 << weight) >> 1;
  }
  // The last byte fills up to a power of two.
  const maxBits = 32 - Math.clz32(sum);
  const rest = (1 << maxBits) - sum;
  const isPower = (rest & (rest - 1)) === 0;
  if (sum === 0 || maxBits > MOST_BITS || !isPower || weights.length > MOST_WEIGHTS)
    throw new ZstdDamage('the weights of a Huffman code do not add up');
  const all = [...weights, 32 - Math.clz32(rest)];
  const entries = new Uint16Array(1 << maxBits);
  let at = 0;
  for (let weight = 1; weight <= maxBits; weight++) {
    for (const [byte, own] of all.entries()) {
      if (own !== weight) continue;
      const end = at + (1 << (weight - 1));
      entries.fill(byte | ((maxBits + 1 - weight) << 8), at, end);
      at = end;
    }
  }
  return { maxBits, entries };
}

/** Decodes bytes `start` to `end`, exactly into bytes `from` to `to` of `into`. */
export function decodeHuffman(
  bytes: Uint8Array,
  start: number,
  end: number,
  { maxBits, entries }: HuffmanTable,
  into: Uint8Array,
  at: number,
  to: number,
): void {
  let left = backwardBits(bytes, start, end);
  const mask = (1 << maxBits) - 1;
  let i = at;
  // Two codes per 24 bits, while enough bits are left.
  for (const last = to - 1; i < last && left >= 24; i += 2) {
    const shift = left - 24;
    const from = start + (shift >> 3);
    const word =
      (bytes[from] | (bytes[from + 1] << 8) | (bytes[from + 2] << 16) | (bytes[from + 3] << 24)) >>>
      (shift & 7);
    const first = entries[(word >> (24 - maxBits)) & mask];
    const used = first >> 8;
    const second = entries[(word >> (24 - maxBits - used)) & mask];
    into[i] = first;
    into[i + 1] = second;
    left -= used + (second >> 8);
  }
  for (; i < to && left > 0; i++) {
    const shift = left - maxBits;
    const from = start + Math.max(0, shift >> 3);
    const word = bytes[from] | (bytes[from + 1] << 8) | (bytes[from + 2] << 16);
    const entry = entries[(shift >= 0 ? word >> (shift & 7) : word << -shift) & mask];
    into[i] = entry;
    left -= entry >> 8;
  }
  if (i !== to || left !== 0) throw new ZstdDamage('a Huffman stream has another length than it says');
}
