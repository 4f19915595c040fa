import { withinCpuTime } from '@websplatter/node/cpu-time';
// Proves: any damage to a Zstandard frame gives bytes or a typed error.
import { decompress } from 'fzstd';
import { describe, expect, test } from 'vitest';
import { SplatFileError } from '../../data/errors.ts';
import { fuzz } from '../../testing/fuzz.ts';
import { unpackZstd } from './zstd.ts';
import { storeZstd, ZSTD_EXAMPLES } from './zstd-fixture.ts';

const unpack = (packed: Uint8Array, length: number) => unpackZstd(packed, length, 'thing.zst', { byte: 7 });

function failure(packed: ArrayLike<number>, length: number): SplatFileError {
  try {
    unpack(Uint8Array.from(packed), length);
  } catch (error) {
    expect(error).toBeInstanceOf(SplatFileError);
    return error as SplatFileError;
  }
  throw new Error('It was unpacked.');
}

const MAGIC = [0x28, 0xb5, 0x2f, 0xfd];
/** A frame of one block, which is the last one; `kind` 0 is raw, 1 a run, 2 packed. */
const frame = (length: number, kind: number, size: number, ...body: number[]) => {
  const head = 1 | (kind << 1) | (size << 3);
  return [...MAGIC, 0x20, length, head & 255, (head >> 8) & 255, head >> 16, ...body];
};

describe('unpacks', () => {
  test.each(ZSTD_EXAMPLES)('$name', ({ unpacked, packed }) => {
    expect(unpack(packed, unpacked.length)).toEqual(unpacked);
    expect(decompress(packed)).toEqual(unpacked);
  });

  test('bytes as they are and runs, over several blocks', () => {
    const bytes = Uint8Array.from({ length: 300_000 }, (_, i) => (i < 140_000 ? 5 : i * i));
    expect(Buffer.compare(unpack(storeZstd(bytes), bytes.length), bytes)).toBe(0);
    expect(unpack(storeZstd(new Uint8Array(0)), 0)).toEqual(new Uint8Array(0));
  });

  test('a Huffman code whose weights are not packed', () => {
    const literals = [0x52, 0x40, 0x01];
    // Of bytes 0 to 3; that of byte 4 follows from them.
    const weights = [127 + 4, 0x11, 0x23];
    const packed = Uint8Array.from(frame(5, 2, 9, ...literals, ...weights, 0x10, 0x69, 0));
    expect(unpack(packed, 5)).toEqual(Uint8Array.of(4, 3, 2, 1, 0));
    expect(decompress(packed)).toEqual(Uint8Array.of(4, 3, 2, 1, 0));
  });

  test('frames one after another, and between them some that are passed over', () => {
    const skipped = [0x53, 0x2a, 0x4d, 0x18, 3, 0, 0, 0, 1, 2, 3];
    const packed = [...frame(2, 0, 2, 8, 9), ...skipped, ...frame(3, 1, 3, 4)];
    expect(unpack(Uint8Array.from(packed), 5)).toEqual(Uint8Array.of(8, 9, 4, 4, 4));
  });
});

describe('refuses', () => {
  const { unpacked, packed } = ZSTD_EXAMPLES[0];

  test('another length than was promised', () => {
    for (const length of [0, 1, unpacked.length - 1]) expect(failure(packed, length).code).toBe('damaged');
    const error = failure(packed, unpacked.length + 1);
    expect(error).toMatchObject({ code: 'damaged', place: { byte: 7 } });
    expect(error.message).toMatch(
      new RegExp(`^thing.zst: it cannot be unpacked: it holds ${unpacked.length} bytes instead of`),
    );
  });

  test('a length that no memory has room for', () => {
    expect(failure(packed, 2 ** 53 - 1).code).toBe('too-large');
  });

  test.each(ZSTD_EXAMPLES)('every beginning of $name', ({ unpacked, packed }) => {
    for (let length = 0; length < packed.length; length++) {
      const { code } = failure(packed.subarray(0, length), unpacked.length);
      if (code !== 'damaged') throw new Error(`${length} bytes are ${code}`);
    }
  });

  /** The weights of its Huffman code take no bits: waiting for the last bit would never end. */
  const endlessWeights = [0xa2, 0x40, 0x02, 6, 0xf0, 3, 255, 255, 255, 128, 0x55, 128, 0];
  const cases = [
    { name: 'no magic number', bytes: [1, 2, 3, 4], says: /does not begin as zstd data does/ },
    { name: 'a dictionary', bytes: [...MAGIC, 0x21, 9, 3, 1, 0, 0], says: /needs a dictionary/ },
    { name: 'a reserved flag', bytes: [...MAGIC, 0x28, 3, 1, 0, 0], says: /frame is of an unknown kind/ },
    { name: 'a reserved block', bytes: frame(3, 3, 0), says: /block is of an unknown kind/ },
    { name: 'a block that is too large', bytes: frame(3, 1, 200_000, 0), says: /block has 200000 bytes/ },
    { name: 'a size that is not kept', bytes: frame(9, 0, 3, 1, 2, 3), says: /more than 4 bytes/ },
    { name: 'a smaller size', bytes: frame(2, 0, 3, 1, 2, 3), says: /does not hold the 2 bytes/ },
    { name: 'a code without end', bytes: frame(3, 2, 13, ...endlessWeights), says: /too many weights/ },
    { name: 'an empty block', bytes: frame(3, 2, 0), says: /block ends too early/ },
    { name: 'a code of no block', bytes: frame(3, 2, 5, 0x33, 0x40, 0, 0, 0), says: /no Huffman code/ },
    {
      name: 'a table of no block',
      bytes: frame(3, 2, 3, 0, 1, 0xc0),
      says: /table that was not there before/,
    },
    { name: 'bytes after a block', bytes: frame(3, 2, 3, 0, 0, 9), says: /bytes after the end of a block/ },
    {
      name: 'an unknown way',
      bytes: frame(3, 2, 3, 0, 1, 1),
      says: /sequences of a block are of an unknown/,
    },
    { name: 'an unknown code', bytes: frame(3, 2, 4, 0, 1, 0x40, 99), says: /sequence has code 99/ },
    // One literal, and a match of the byte before the first one.
    {
      name: 'a match of nothing',
      bytes: frame(3, 2, 7, 0, 1, 0x54, 0, 0, 0, 1),
      says: /refers to what is not there/,
    },
    { name: 'too few bits', bytes: frame(3, 2, 8, 8, 7, 1, 0x54, 1, 0, 52, 1), says: /end too early/ },
    {
      name: 'a match of too much',
      bytes: frame(3, 2, 8, 8, 7, 1, 0x54, 1, 0, 31, 1),
      says: /holds more bytes/,
    },
    {
      name: 'too many bits',
      bytes: frame(4, 2, 8, 8, 7, 1, 0x54, 1, 0, 0, 2),
      says: /bits after the sequences/,
    },
  ];
  test.each(cases)('$name', ({ bytes, says }) => {
    const error = failure(bytes, 4);
    expect(error.code).toBe('damaged');
    expect(error.message).toMatch(says);
  });
});

/**
 * @fault Files: a Zstandard frame that never ends
 * @consequence `SplatFileError` `damaged`, at once
 */
test('any damage gives bytes or a typed error, at once', { tags: 'deeper', timeout: 3_600_000 }, async () => {
  await fuzz({ few: 300, many: 50_000 }, async (choices) => {
    const { unpacked, packed } = choices.of(ZSTD_EXAMPLES);
    const bytes = Uint8Array.from(packed);
    for (let i = choices.below(4); i >= 0; i--)
      bytes[choices.below(bytes.length)] = choices.of([0, 255, choices.below(256)]);
    try {
      const { length } = await withinCpuTime(2000, () => unpack(bytes, unpacked.length));
      expect(length).toBe(unpacked.length);
    } catch (error) {
      if (!(error instanceof SplatFileError && error.code === 'damaged')) throw error;
    }
  });
});
