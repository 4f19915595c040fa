import { expect, test } from 'vitest';
import { minPsnrOf } from './run-images.ts';

const cause = 'halves stall';
const BOUNDS = { high: { minPsnrDb: 30, minPsnrTruncatedDb: 23, cause }, balanced: { minPsnrDb: 29, cause } };
const FLOATS = { colorTarget: 'rgba32float', isTruncating: false } as const;
const HALVES = { colorTarget: 'rgba16float', isTruncating: false } as const;
const TRUNCATED = { ...HALVES, isTruncating: true } as const;

test.each([
  ['of reference alone by default', undefined, 'reference', FLOATS, 55],
  ['none of others by default', undefined, 'high', HALVES, null],
  ['the same of reference in halves, but for bounds', undefined, 'reference', TRUNCATED, 55],
  ['of reference, whatever bounds high', BOUNDS, 'reference', FLOATS, 55],
  ['of high for reference in halves', BOUNDS, 'reference', HALVES, 30],
  ['of its own', BOUNDS, 'high', HALVES, 30],
  ['another where halves are truncated', BOUNDS, 'high', TRUNCATED, 23],
  ['the same there where the case tells no other', BOUNDS, 'balanced', TRUNCATED, 29],
  ['another for reference too', BOUNDS, 'reference', TRUNCATED, 23],
] as const)('the bound is %s', (_, bounds, preset, target, expected) => {
  expect(minPsnrOf(bounds, preset, target)).toBe(expected);
});
