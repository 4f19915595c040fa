import { describe, expect, test } from 'vitest';
import { centersOf, coefficientsOf, expectInvalid } from '../../testing/edited-splats.ts';
import { randomSplats, splatsOf } from '../../testing/random-splats.ts';
import type { Vec3 } from '../math/mat4.ts';
import { cropPiece, cropSplats } from './crop-splats.ts';

describe('cropSplats', () => {
  test('keeps the splats within, sides included, as they are', () => {
    const set = { ...randomSplats({ count: 100, shDegree: 1 }), origin: [1e6, 0, -7] as const };
    const min: Vec3 = [1e6 - 1, -1, -8];
    const max: Vec3 = [1e6 + set.positions[21], 1, -6];
    const centers = centersOf(set);
    const expected = [...set.fileIndices].filter((i) =>
      [0, 1, 2].every((axis) => centers[3 * i + axis] >= min[axis] && centers[3 * i + axis] <= max[axis]),
    );
    expect(expected).toContain(7);
    expect(expected.length).toBeLessThan(100);
    const cropped = cropSplats(set, { min, max });
    expect([...cropped.fileIndices]).toEqual(expected);
    for (const [i, from] of expected.entries()) {
      expect(cropped.positions.subarray(3 * i, 3 * i + 3)).toEqual(
        set.positions.subarray(3 * from, 3 * from + 3),
      );
      expect(coefficientsOf(cropped, i)).toEqual(coefficientsOf(set, from));
    }
    expect(cropped.origin).toBe(set.origin);
  });

  test('keeps the others where the box goes', () => {
    const set = splatsOf([{ position: [0, 0, 0] }, { position: [1, 2, 3] }, { position: [5, 5, 5] }]);
    const cropped = cropSplats(set, { min: [1, 2, 3], max: [2, 3, 4], keep: 'outside' });
    expect([...cropped.fileIndices]).toEqual([0, 2]);
    expectInvalid('box', () => cropSplats(set, { min: [0, 0, 0], max: [5, 5, 5], keep: 'outside' }));
    expectInvalid('box', () => cropSplats(set, { min: [0, 0, 0], max: [9, 9, 9], keep: 'both' as 'inside' }));
  });

  test('wants a box with something in it', () => {
    const set = splatsOf([{ position: [1, 2, 3] }]);
    expect(cropSplats(set, { min: [1, 2, 3], max: [1, 2, 3] }).count).toBe(1);
    expect(cropPiece(set, { min: [0, 0, 0], max: [1, 1, 1] }).count).toBe(0);
    expectInvalid('box', () => cropPiece(set, { min: [0, 2, 0], max: [1, 1, 1] }));
    expectInvalid('box', () => cropSplats(set, { min: [0, 0, 0], max: [1, 1, 1] }));
    expectInvalid('box', () => cropSplats(set, { min: [0, 2, 0], max: [1, 1, 1] }));
    expectInvalid('box', () => cropSplats(set, { min: [0, Number.NaN, 0], max: [1, 1, 1] }));
  });
});
