import { describe, expect, test } from 'vitest';
import { Chance } from './chance.ts';

const ITEMS = [
  { name: 'rare', weight: 1 },
  { name: 'often', weight: 9 },
  { name: 'never', weight: 0 },
];

describe('Chance', () => {
  test('chooses the same for the same seed, and something else for another', () => {
    const chosenBy = (seed: number) => {
      const chance = new Chance(seed);
      return Array.from({ length: 50 }, () => [chance.weighted(ITEMS).name, chance.whole(1, 6)]);
    };
    expect(chosenBy(5)).toEqual(chosenBy(5));
    expect(chosenBy(6)).not.toEqual(chosenBy(5));
  });

  test('chooses each as often as it weighs', () => {
    const chance = new Chance(1);
    const counts: Record<string, number> = {};
    for (let i = 0; i < 10_000; i++) {
      const { name } = chance.weighted(ITEMS);
      counts[name] = (counts[name] ?? 0) + 1;
    }
    expect(counts.rare).toBeGreaterThan(900);
    expect(counts.rare).toBeLessThan(1100);
    expect(counts.never).toBeUndefined();
  });

  test('stays within its bounds, and reaches both ends of whole numbers', () => {
    const chance = new Chance(2);
    const found = new Set(Array.from({ length: 200 }, () => chance.whole(3, 5)));
    expect([...found].sort()).toEqual([3, 4, 5]);
    expect(chance.vector(2).every((value) => Math.abs(value) <= 2)).toBe(true);
  });
});
