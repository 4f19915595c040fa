import { expect, test } from 'vitest';
import { minPsnrOf } from './run-images.ts';

const cause = 'halves stall';
const BOUNDS = { high: { minPsnrDb: 30, minPsnrTruncatedDb: 23, cause }, balanced: { minPsnrDb: 29, cause } };
const PLAIN = { kind: 'scene' } as const;
const BOUNDED = { kind: 'scene', bounds: BOUNDS } as const;
const DEVICE = { kind: 'device' } as const;

const FLOATS = { rasterizer: 'quads', colorTarget: 'rgba32float', isTruncating: false } as const;
const HALVES = { rasterizer: 'quads', colorTarget: 'rgba16float', isTruncating: false } as const;
const TRUNCATED = { ...HALVES, isTruncating: true } as const;
const TILES = { ...TRUNCATED, rasterizer: 'tiles' } as const;

test.each([
  ['of reference alone by default', PLAIN, 'reference', FLOATS, 55],
  ['none of others by default', PLAIN, 'high', HALVES, null],
  ['none of reference that quads draw in halves', PLAIN, 'reference', HALVES, null],
  ['the same of reference by tiles', PLAIN, 'reference', TILES, 55],
  ['the same in cases about devices', DEVICE, 'reference', TRUNCATED, 55],
  ['of reference, whatever bounds high', BOUNDED, 'reference', FLOATS, 55],
  ['of high for reference that quads draw in halves', BOUNDED, 'reference', HALVES, 30],
  ['of its own', BOUNDED, 'high', HALVES, 30],
  ['another where halves are truncated', BOUNDED, 'high', TRUNCATED, 23],
  ['the same there where the case tells no other', BOUNDED, 'balanced', TRUNCATED, 29],
  ['another for reference too', BOUNDED, 'reference', TRUNCATED, 23],
] as const)('the bound is %s', (_, hardCase, preset, target, expected) => {
  expect(minPsnrOf(hardCase, { preset, ...target })).toBe(expected);
});
