import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { depthKey, orderedBits, orderedWords, shortDepthKey, type WideKey, wideKey } from './depth-key.ts';

const anyDepth = fc.float({ noNaN: true, noDefaultInfinity: true });

describe('depth keys', () => {
  test('ordered bits are in the order of the numbers, negative ones included', () => {
    fc.assert(
      fc.property(anyDepth, anyDepth, (a, b) => {
        expect(Math.sign(orderedBits(a) - orderedBits(b))).toBe(Math.sign(a - b) + 0);
      }),
      { numRuns: 2000 },
    );
  });

  test('neighbouring float32 numbers have neighbouring bits, across zero and powers of two', () => {
    for (const value of [1, 2, 1024, 2 ** -126, -1, -2, -(2 ** -126)]) {
      const below = nextBelow(value);
      expect(orderedBits(value) - orderedBits(below)).toBe(1);
    }
    expect(orderedBits(2 ** -149) - orderedBits(0)).toBe(1);
  });

  test('both zeros have the same key', () => {
    expect(orderedBits(-0)).toBe(orderedBits(0));
  });

  test('are far first: 0 for the farthest depth, and for any that rounding puts beyond it', () => {
    const farthest = orderedBits(10);
    expect(depthKey(10, farthest)).toBe(0);
    expect(depthKey(10.00001, farthest)).toBe(0);
    expect(depthKey(9.5, farthest)).toBeLessThan(depthKey(9, farthest));
    expect(depthKey(-5, farthest)).toBeGreaterThan(depthKey(5, farthest));
    expect(depthKey(-3e38, orderedBits(3e38))).toBeLessThan(2 ** 32);
  });
});

describe('wide keys', () => {
  const any = fc.double({ noNaN: true, noDefaultInfinity: true });
  const order = (a: WideKey, b: WideKey) => Math.sign(a.high - b.high) || Math.sign(a.low - b.low);

  test('order numbers as float64 does, negative ones and neighbours included, and both zeros as one', () => {
    const pair = fc.oneof(
      fc.tuple(any, any),
      any.map((value) => [value, value * (1 + 2 ** -52)] as const),
    );
    fc.assert(
      fc.property(pair, ([a, b]) => {
        fc.pre(Number.isFinite(b));
        expect(order(orderedWords(a), orderedWords(b))).toBe(Math.sign(a - b) + 0);
      }),
      { numRuns: 2000 },
    );
    expect(orderedWords(-0)).toEqual(orderedWords(0));
  });

  test('are far first, and those beyond the farthest begin with 0', () => {
    const { high } = orderedWords(10);
    expect(wideKey(10.5, high).high).toBe(0);
    expect(wideKey(1e300, high).high).toBe(0);
    expect(order(wideKey(9, high), wideKey(9 - 2 ** -49, high))).toBe(-1);
    expect(order(wideKey(1, high), wideKey(-1, high))).toBe(-1);
  });
});

function nextBelow(value: number): number {
  const f32 = Float32Array.of(value);
  const bits = new Int32Array(f32.buffer);
  bits[0] += value > 0 ? -1 : 1;
  return f32[0];
}

describe('short keys', () => {
  test('have the requested length, keep the order, and end where the range does', () => {
    const depth = fc.float({ min: Math.fround(1e-3), max: Math.fround(1e5), noNaN: true });
    const bits = fc.constantFrom(24, 16);
    fc.assert(
      fc.property(depth, depth, depth, depth, bits, (one, other, a, b, keyBits) => {
        const [nearest, farthest] = [Math.min(one, other), Math.max(one, other)].map(orderedBits);
        const key = (depthView: number) => shortDepthKey(depthView, farthest, nearest, keyBits);
        // Far first; depths beyond the ends are clamped to them.
        if (a <= b) expect(key(a)).toBeGreaterThanOrEqual(key(b));
        for (const each of [a, b]) expect(key(each)).toBeLessThan(2 ** keyBits);
        expect(key(1e6)).toBe(0);
        const range = farthest - nearest;
        if (range < 2 ** keyBits) expect(key(Math.min(one, other))).toBe(range);
        else expect(key(Math.min(one, other))).toBeGreaterThanOrEqual(2 ** (keyBits - 1));
      }),
    );
  });
});
