import { resolveAccuracy } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { describeTarget } from '../ui/accuracy-words.ts';
import { decodeAccuracy, encodeAccuracy } from './accuracy-address.ts';

describe('accuracy in the address', () => {
  it.each([
    ['fast', 'fast'],
    ['balanced', null],
    [{ preset: 'high', alphaCutoff: 0.02 }, 'high,alphaCutoff:0.02'],
    [{ sortKeyBits: 16, shPrecision: 'u8' }, 'balanced,sortKeyBits:16'],
  ] as const)('writes %o as %s and reads it back', (accuracy, text) => {
    const settings = resolveAccuracy(accuracy);
    expect(encodeAccuracy(settings)).toBe(text);
    expect(decodeAccuracy(text)).toEqual(settings);
  });

  it.each([
    [{ minPsnrDb: 45 }, 'minPsnrDb:45', 'at least 45 dB'],
    [{ maxFrameMs: 0.5 }, 'maxFrameMs:0.5', 'at most 0.5 ms'],
  ])('writes the target %o as %s, and for people', (target, text, words) => {
    expect(encodeAccuracy(target)).toBe(text);
    expect(decodeAccuracy(text)).toEqual(target);
    expect(describeTarget(target)).toBe(words);
  });

  it('names the usual default where the device has another, which it does not', () => {
    const reference = resolveAccuracy('reference');
    expect(encodeAccuracy(resolveAccuracy(), reference)).toBe('balanced');
    expect(encodeAccuracy(resolveAccuracy('reference'), reference)).toBeNull();
    expect(encodeAccuracy(reference, null)).toBe('reference');
  });

  it('takes changes of the default without its name', () => {
    expect(decodeAccuracy('sortKeyBits:16')).toMatchObject({ sortKeyBits: 16 });
  });

  it.each(['best', 'fast,nonsense:1', 'fast,sortKeyBits:9', 'fast,sortKeyBits', 'fast,sortKeyBits:', ''])(
    'refuses %j with what would do',
    (text) => expect(() => decodeAccuracy(text)).toThrow(/there are|must be|must lie/),
  );

  it.each(['minPsnrDb:0', 'minPsnrDb:', 'minPsnrDb:1e999', 'maxFrameMs:soon', 'fast,minPsnrDb:45'])(
    'refuses the target %j with what would do',
    (text) => expect(() => decodeAccuracy(text)).toThrow(/write minPsnrDb|there are/),
  );
});
