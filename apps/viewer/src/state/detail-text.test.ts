import { InvalidArgumentError } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { describeDetail } from '../ui/detail-words.ts';
import { decodeDetail, encodeDetail } from './detail-text.ts';

describe('detail in the address', () => {
  it.each([
    [{ maxSplats: 1_200_000 }, 'maxSplats:1200000', 'at most 1.2 million splats'],
    [{ maxSplats: 5000 }, 'maxSplats:5000', 'at most 5,000 splats'],
    ['full', 'full', ''],
    ['auto', 'auto', 'automatic detail'],
    [{ maxShare: 0.25 }, 'maxShare:0.25', 'at most 25 % in sight'],
    [{ maxFrameMs: 8 }, 'maxFrameMs:8', 'splats for 8 ms'],
    [{ minPsnrDb: 40 }, 'minPsnrDb:40', 'splats for 40 dB'],
    [{ maxErrorPx: 0.5 }, 'maxErrorPx:0.5', 'errors up to 0.5 px'],
    [
      { maxErrorPx: 0.1, maxSplats: 999_950 },
      'maxErrorPx:0.1,maxSplats:999950',
      'errors up to 0.1 px, at most 1.0 million splats',
    ],
  ] as const)('writes %o as %s, and for people', (detail, text, words) => {
    expect(encodeDetail(detail)).toBe(text);
    expect(decodeDetail(text)).toEqual(detail);
    expect(describeDetail(detail)).toBe(words);
  });

  it.each([
    '',
    'half',
    'maxSplats:',
    'maxSplats:many',
    'maxSplats:1e999',
    'maxSplats:0.5',
    'maxErrorPx:-1',
    'minPsnrDb:40,maxSplats:500',
  ])('refuses %j with what would do', (text) => {
    expect(() => decodeDetail(text)).toThrow(InvalidArgumentError);
    expect(() => decodeDetail(text)).toThrow('{ maxSplats: 1e6 }');
  });
});
