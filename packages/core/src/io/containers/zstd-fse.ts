/** A finite state entropy decoder (RFC 8878, section 4.1): symbol and successor of each state. */
export interface FseTable {
  /** Log2 of the number of states. */
  readonly log: number;
  readonly symbols: Uint8Array;
  /** Number of bits to read and add to `bases` for the next state. */
  readonly bits: Uint8Array;
  readonly bases: Uint16Array;
}

/** A table, and the offset after its description. */
interface ReadTable {
  readonly table: FseTable;
  readonly end: number;
}

const LEAST_LOG = 5;
/** Special probability: the symbol has one state, which resets to any state. */
const LESS_THAN_ONE = -1;

/** Reads a table description from byte `start`, up to byte `limit`. */
export function readFseTable(
  bytes: Uint8Array,
  start: number,
  limit: number,
  { maxLog, maxSymbol }: { readonly maxLog: number; readonly maxSymbol: number },
): ReadTable {
  const limitBit = 8 * limit;
  let bit = 8 * start;
  const peek = (count: number) => {
    const at = bit >> 3;
    const word = (bytes[at] ?? 0) | ((bytes[at + 1] ?? 0) << 8) | ((bytes[at + 2] ?? 0) << 16);
    return (word >> (bit & 7)) & ((1 << count) - 1);
  };
  const log = peek(4) + LEAST_LOG;
  bit += 4;
  if (log > maxLog) throw new ZstdDamage(`a table has 2^${log} states`);
  const probabilities: number[] = [];
  let left = 1 << log;
  while (left > 0) {
    if (probabilities.length > maxSymbol || bit > limitBit) throw new ZstdDamage('a table has no end');
    // Values from 0 to left + 1; the lower ones take one bit less.
    const bits = 32 - Math.clz32(left + 1);
    const shortOnes = (1 << bits) - 2 - left;
    let value = peek(bits - 1);
    if (value < shortOnes) bit += bits - 1;
    else {
      value = peek(bits);
      if (value >= 1 << (bits - 1)) value -= shortOnes;
      bit += bits;
    }
    const probability = value - 1;
    probabilities.push(probability);
    left -= Math.abs(probability);
    if (probability !== 0) continue;
    let zeros: number;
    do {
      zeros = peek(2);
      bit += 2;
      for (let i = 0; i < zeros; i++) probabilities.push(0);
    } while (zeros === 3 && bit <= limitBit);
  }
  if (left < 0 || probabilities.length > maxSymbol + 1 || bit > limitBit)
    throw new ZstdDamage('a table has too many states');
  return { table: fseTable(probabilities, log), end: (bit + 7) >> 3 };
}

/** @param probabilities number of states per symbol; the sum is 2^log. */
export function fseTable(probabilities: readonly number[], log: number): FseTable {
  const size = 1 << log;
  const symbols = new Uint8Array(size);
  let end = size;
  const next = probabilities.map((probability, symbol) => {
    if (probability === LESS_THAN_ONE) symbols[--end] = symbol;
    return Math.abs(probability);
  });
  const step = (size >> 1) + (size >> 3) + 3;
  let at = 0;
  for (const [symbol, probability] of probabilities.entries()) {
    for (let i = 0; i < probability; i++) {
      symbols[at] = symbol;
      do at = (at + step) & (size - 1);
      while (at >= end);
    }
  }
  const bits = new Uint8Array(size);
  const bases = new Uint16Array(size);
  for (let state = 0; state < size; state++) {
    const count = next[symbols[state]]++;
    bits[state] = log - (31 - Math.clz32(count));
    bases[state] = (count << bits[state]) - size;
  }
  return { log, symbols, bits, bases };
}

/** A table with one symbol for every state. */
export function constantFseTable(symbol: number): FseTable {
  return { log: 0, symbols: Uint8Array.of(symbol), bits: new Uint8Array(1), bases: new Uint16Array(1) };
}

/**
 * Number of bits in a stream that is read backwards, from byte `start` to before byte `end`. The
 * highest set bit of its last byte is an end marker.
 */
export function backwardBits(bytes: Uint8Array, start: number, end: number): number {
  const last = end > start ? bytes[end - 1] : 0;
  if (last === 0) throw new ZstdDamage('a stream of bits has no end mark');
  return 8 * (end - start) - 1 - (Math.clz32(last) - 24);
}

/** A fault of Zstandard data; the message completes "it cannot be unpacked:". */
export class ZstdDamage extends Error {}
