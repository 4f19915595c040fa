import { expect, test } from 'vitest';
import { crc32 } from './crc32.ts';

/** The definition, bit by bit. */
function slowCrc32(bytes: Uint8Array): number {
  let crc = -1;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit++) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}

const BYTES = Uint8Array.from({ length: 41 }, (_, i) => (i * 167 + 13) & 255);

test('the check value of the standard', () => {
  expect(crc32(new TextEncoder().encode('123456789'))).toBe(0xcbf43926);
});

test('any number of bytes, from any place, at once or in two parts', () => {
  for (let length = 0; length <= 40; length++) {
    const bytes = BYTES.subarray(1, 1 + length);
    const expected = slowCrc32(bytes);
    expect(crc32(bytes)).toBe(expected);
    for (let first = 0; first <= length; first++)
      expect(crc32(bytes.subarray(first), crc32(bytes.subarray(0, first)))).toBe(expected);
  }
});
