import { describe, expect, test } from 'vitest';
import { coefficientsOf } from '../../testing/edited-splats.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { coefficientsPerSplat, type ShDegree } from '../splats/splat-set.ts';
import { limitDegree } from './limit-degree.ts';

describe('limitDegree', () => {
  test.each<ShDegree>([0, 1, 2])('keeps the bands up to %i as they are', (degree) => {
    const set = randomSplats({ count: 5, shDegree: 3 });
    const limited = limitDegree(set, degree);
    expect(limited.harmonics.degree).toBe(degree);
    for (let i = 0; i < 5; i++)
      expect(coefficientsOf(limited, i)).toEqual(
        coefficientsOf(set, i).subarray(0, coefficientsPerSplat(degree)),
      );
  });

  test('changes nothing where there are no higher ones', () => {
    const set = randomSplats({ count: 2, shDegree: 1 });
    expect(limitDegree(set, 1)).toBe(set);
    expect(limitDegree(set, 3)).toBe(set);
  });
});
