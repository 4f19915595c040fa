import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { depthKey, orderedBits } from './depth-key.ts';

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

  test('both zeros are one key', () => {
    expect(orderedBits(-0)).toBe(orderedBits(0));
  });

  test('are far first: 0 for the farthest and whatever rounding puts beyond it', () => {
    const farthest = orderedBits(10);
    expect(depthKey(10, farthest)).toBe(0);
    expect(depthKey(10.00001, farthest)).toBe(0);
    expect(depthKey(9.5, farthest)).toBeLessThan(depthKey(9, farthest));
    expect(depthKey(-5, farthest)).toBeGreaterThan(depthKey(5, farthest));
    expect(depthKey(-3e38, orderedBits(3e38))).toBeLessThan(2 ** 32);
  });
});

function nextBelow(value: number): number {
  const f32 = Float32Array.of(value);
  const bits = new Int32Array(f32.buffer);
  bits[0] += value > 0 ? -1 : 1;
  return f32[0];
}
