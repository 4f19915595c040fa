import { describe, expect, test } from 'vitest';
import { centersOf, coefficientsOf, expectInvalid } from '../../testing/edited-splats.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { mergeSplats } from './merge-splats.ts';

describe('mergeSplats', () => {
  test('puts set after set, with the highest degree', () => {
    const [a, b] = [
      randomSplats({ count: 3, shDegree: 1 }),
      randomSplats({ count: 2, seed: 2, shDegree: 3 }),
    ];
    const merged = mergeSplats([
      { ...a, dropped: { 'non-finite-color': 1 } },
      { ...b, dropped: { 'non-finite-color': 2, 'non-finite-scale': 1 } },
    ]);
    expect(merged).toMatchObject({ count: 5, origin: [0, 0, 0], harmonics: { degree: 3 } });
    expect(merged.dropped).toEqual({ 'non-finite-color': 3, 'non-finite-scale': 1 });
    expect([...merged.fileIndices]).toEqual([0, 1, 2, 3, 4]);
    for (const column of ['positions', 'logScales', 'rotations', 'opacityLogits', 'colorDc'] as const)
      expect([...merged[column]]).toEqual([...a[column], ...b[column]]);
    expect([...coefficientsOf(merged, 2)]).toEqual([...coefficientsOf(a, 2), ...new Array(36).fill(0)]);
    expect(coefficientsOf(merged, 3)).toEqual(coefficientsOf(b, 0));
  });

  test('takes positions of several origins to one that suits all', () => {
    const a = randomSplats({ count: 3, origin: [4_500_000, 0, 0] });
    const b = randomSplats({ count: 3, seed: 2, origin: [4_500_100, 0, 0] });
    const merged = mergeSplats([a, b]);
    expect(merged.origin[0]).toBeCloseTo(4_500_050, -1);
    // Relative positions are within 64 of the origin.
    const bound = 64 * 2 ** -24;
    for (const [i, center] of [...centersOf(a), ...centersOf(b)].entries())
      expect(Math.abs(centersOf(merged)[i] - center)).toBeLessThanOrEqual(bound);
    expect(mergeSplats([a, a]).origin).toEqual(a.origin);
  });

  test('is antialiased only where all say so', () => {
    const sets = (...flags: (boolean | undefined)[]) =>
      flags.map((isAntialiased) => ({ ...randomSplats({ count: 1 }), isAntialiased }));
    expect(mergeSplats(sets(true, true)).isAntialiased).toBe(true);
    expect(mergeSplats(sets(false, false)).isAntialiased).toBe(false);
    expect(mergeSplats(sets(true, false)).isAntialiased).toBeUndefined();
    expect(mergeSplats(sets(undefined, true)).isAntialiased).toBeUndefined();
  });

  test('of one set is that set, and of none is nothing', () => {
    const set = randomSplats({ count: 1 });
    expect(mergeSplats([set])).toBe(set);
    expectInvalid('sets', () => mergeSplats([]));
  });
});
