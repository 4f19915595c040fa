import { InvalidArgumentError } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { describeDetail } from '../formatting/detail-words.ts';
import { decodeDetail, encodeDetail } from './detail-text.ts';

describe('detail in the address', () => {
  it.each([
    [{ maxSplats: 1_200_000 }, 'maxSplats:1200000', 'at most 1.2 million splats'],
    [{ maxSplats: 5000 }, 'maxSplats:5000', 'at most 5,000 splats'],
    [{ maxErrorPx: 0.5 }, 'maxErrorPx:0.5', 'errors up to 0.5 px'],
    [
      { maxErrorPx: 0.1, maxSplats: 999_950 },
      'maxErrorPx:0.1,maxSplats:999950',
      'errors up to 0.1 px, at most 1.0 million splats',
    ],
  ])('writes %o as %s, and for people', (detail, text, words) => {
    expect(encodeDetail(detail)).toBe(text);
    expect(decodeDetail(text)).toEqual(detail);
    expect(describeDetail(detail)).toBe(words);
  });

  it('does not mention full detail, and takes it by name', () => {
    expect(encodeDetail('full')).toBeNull();
    expect(decodeDetail('full')).toBe('full');
    expect(describeDetail('full')).toBe('');
  });

  it.each([
    ['', '“” is none of its parts'],
    ['half', '“half” is none of its parts'],
    ['toString:1', '“toString:1” is none of its parts'],
    ['maxSplats:', 'a number is missing'],
    ['maxSplats:many', '“many” is no number'],
    ['maxSplats:1e999', '“1e999” is no number'],
    ['maxSplats:0', 'maxSplats cannot be 0'],
    ['maxSplats:0.5', 'maxSplats cannot be 0.5'],
    ['maxErrorPx:-1', 'maxErrorPx cannot be -1'],
  ])('refuses %j with what is wrong and what would do', (text, why) => {
    expect(() => decodeDetail(text)).toThrow(InvalidArgumentError);
    expect(() => decodeDetail(text)).toThrow(why);
    expect(() => decodeDetail(text)).toThrow('write detail=maxSplats');
  });
});
