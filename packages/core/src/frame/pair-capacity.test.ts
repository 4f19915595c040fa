import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { DEFAULT_TILE_BUDGET_BYTES, PAIR_BYTES, pairCapacity } from './pair-capacity.ts';

const MOST = 22_000_000;

describe('pairCapacity', () => {
  test('guesses a pair per visible splat before any number is known, and more where that costs little', () => {
    const first = pairCapacity(0, null, 1_000_000, MOST);
    expect(first).toBeGreaterThan(1_000_000);
    expect(first).toBeLessThan(1_400_000);
    expect(pairCapacity(0, null, 10_000, MOST)).toBeGreaterThan(40_000);
    expect(pairCapacity(0, null, 100_000, MOST)).toBeGreaterThan(250_000);
    expect(pairCapacity(0, null, 100_000, MOST)).toBeLessThan(300_000);
  });

  test('has spare room for what a recent frame needed, and is kept while that suits', () => {
    const room = pairCapacity(0, 1_000_000, 5000, MOST);
    expect(room).toBeGreaterThan(1_100_000);
    expect(room).toBeLessThan(1_400_000);
    for (const needed of [1_200_000, 1_000_000, Math.ceil(0.4 * room)])
      expect(pairCapacity(room, needed, 5000, MOST)).toBe(room);
  });

  test('grows if a frame needed more, and shrinks if it needed much less', () => {
    expect(pairCapacity(100_000, 100_001, 5000, MOST)).toBeGreaterThan(100_001);
    // Before it is too late: the next frame may need a little more.
    expect(pairCapacity(100_000, 95_000, 5000, MOST)).toBeGreaterThan(100_000);
    expect(pairCapacity(1_000_000, 399_999, 5000, MOST)).toBeLessThan(600_000);
  });

  test('ends at what budget and device allow, even if a frame needs more', () => {
    expect(pairCapacity(0, 30_000_000, 5000, MOST)).toBe(MOST);
    expect(pairCapacity(MOST, 30_000_000, 5000, MOST)).toBe(MOST);
    // A smaller budget than before.
    expect(pairCapacity(MOST, 20_000_000, 5000, 1000)).toBe(1000);
  });

  test('is never nothing, since buffers cannot be empty', () => {
    for (const most of [0, 1, MOST]) {
      expect(pairCapacity(0, null, 0, most)).toBeGreaterThan(0);
      expect(pairCapacity(0, 0, 0, most)).toBeGreaterThan(0);
    }
  });

  test('settles: with the same needs, the next frame changes nothing', () => {
    const pairs = fc.integer({ min: 0, max: 2 ** 31 });
    const needs = fc.option(pairs);
    fc.assert(
      fc.property(
        pairs,
        needs,
        pairs,
        fc.integer({ min: 1, max: 2 ** 25 }),
        (current, needed, visible, most) => {
          const room = pairCapacity(current, needed, visible, most);
          expect(room).toBeGreaterThan(0);
          expect(room).toBeLessThanOrEqual(most);
          const wanted = needed ?? visible;
          if (wanted <= most) expect(room).toBeGreaterThanOrEqual(wanted);
          expect(pairCapacity(room, needed, visible, most)).toBe(room);
        },
      ),
    );
  });

  test('holds 8 bytes of keys and records, and a bit per tile of a bin, per pair', () => {
    expect(PAIR_BYTES).toBe(16);
    expect(Math.floor(DEFAULT_TILE_BUDGET_BYTES / PAIR_BYTES)).toBeGreaterThan(MOST);
  });
});
