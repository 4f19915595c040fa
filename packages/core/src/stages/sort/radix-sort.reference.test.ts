import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { compactChunks, compactSplats, prefixScan } from '../cull/cull.reference.ts';
import { radixSort } from './sort.reference.ts';

describe('the integer references', () => {
  test('the radix sort is a stable sort', () => {
    const shape = fc.constantFrom(
      { digitBits: 8, passes: 4, blockKeys: 7 },
      { digitBits: 9, passes: 4, blockKeys: 1000 },
      { digitBits: 4, passes: 8, blockKeys: 1 },
    );
    const key = fc.oneof(fc.nat(3), fc.integer({ min: 0, max: 2 ** 32 - 1 }));
    fc.assert(
      fc.property(fc.array(key, { maxLength: 200 }), shape, (keys, options) => {
        const expected = keys.map((_, i) => i).sort((a, b) => keys[a] - keys[b] || a - b);
        expect(Array.from(radixSort(keys, options))).toEqual(expected);
      }),
    );
  });

  test('wide keys are sorted by both words', () => {
    const shape = fc.constantFrom(
      { digitBits: 8, passes: 8, blockKeys: 7 },
      { digitBits: 4, passes: 16, blockKeys: 100 },
    );
    const word = fc.oneof(fc.nat(3), fc.integer({ min: 0, max: 2 ** 32 - 1 }));
    fc.assert(
      fc.property(fc.array(fc.tuple(word, word), { maxLength: 200 }), shape, (keys, options) => {
        const [low, high] = [keys.map((key) => key[0]), keys.map((key) => key[1])];
        const expected = keys.map((_, i) => i).sort((a, b) => high[a] - high[b] || low[a] - low[b] || a - b);
        expect(Array.from(radixSort(low, options, high))).toEqual(expected);
      }),
    );
  });

  test('the scan has one more sum than counts, and wraps at 2^32', () => {
    expect(Array.from(prefixScan([]))).toEqual([0]);
    expect(Array.from(prefixScan([3, 0, 5]))).toEqual([0, 3, 3, 8]);
    expect(Array.from(prefixScan([2 ** 32 - 1, 2]))).toEqual([0, 2 ** 32 - 1, 1]);
  });

  test('compaction keeps storage order', () => {
    expect(compactChunks([0, 1, 1, 0, 1])).toEqual([1, 2, 4]);
    const masks = new Uint32Array(16);
    masks[0] = 0b101;
    masks[7] = 0x80000000;
    masks[9] = 1;
    const all = [512, 514, 767, 1280 + 32];
    expect(compactSplats([2, 5], masks, 1000)).toEqual(all);
    expect(compactSplats([2, 5], masks, 3)).toEqual(all.slice(0, 3));
  });
});
