import { InvalidArgumentError, resolveAccuracy } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { decodeComparison, encodeComparison } from './comparison-text.ts';

const balanced = resolveAccuracy('balanced');
const coarse = resolveAccuracy({ preset: 'fast', resolutionScale: 0.5 });

describe('a comparison in the address', () => {
  it.each([
    ['error', { comparison: { kind: 'error' }, splitPart: 0.5 }],
    [
      'current/balanced/0.25',
      { comparison: { kind: 'split', left: 'current', right: balanced }, splitPart: 0.25 },
    ],
    [
      'fast,resolutionScale:0.5/current/1',
      { comparison: { kind: 'split', left: coarse, right: 'current' }, splitPart: 1 },
    ],
  ] as const)('is %s, and comes back', (text, linked) => {
    expect(encodeComparison(linked)).toBe(text);
    expect(decodeComparison(text)).toEqual(linked);
  });

  it('has its line in the middle where none is named', () => {
    expect(decodeComparison('current/fast').splitPart).toBe(0.5);
  });

  it.each([
    ['', 'two sides'],
    ['fast', 'two sides'],
    ['fast/fast/0.5/1', 'two sides'],
    ['fast/high/', 'its line'],
    ['fast/high/2', 'its line, “2”'],
    ['fast/minPsnrDb:45', 'is a target'],
    ['fast/best', 'best'],
  ])('refuses %j with what is wrong', (text, why) => {
    expect(() => decodeComparison(text)).toThrow(InvalidArgumentError);
    expect(() => decodeComparison(text)).toThrow(why);
  });
});
