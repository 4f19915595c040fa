import { describe, expect, test } from 'vitest';
import { coefficientsOf } from '../../testing/edited-splats.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { filterSplats } from './crop-splats.ts';

describe('filterSplats', () => {
  const set = randomSplats({ count: 40, shDegree: 1 });

  test('keeps the splats to stay as they are, with their rows', () => {
    const filtered = filterSplats(set, (i) => set.fileIndices[i] % 3 === 1);
    expect([...filtered.fileIndices]).toEqual([...set.fileIndices].filter((row) => row % 3 === 1));
    for (let i = 0; i < filtered.count; i++) {
      const from = set.fileIndices.indexOf(filtered.fileIndices[i]);
      expect(filtered.positions.subarray(3 * i, 3 * i + 3)).toEqual(
        set.positions.subarray(3 * from, 3 * from + 3),
      );
      expect(filtered.opacityLogits[i]).toBe(set.opacityLogits[from]);
      expect(coefficientsOf(filtered, i)).toEqual(coefficientsOf(set, from));
    }
    expect(filtered.origin).toBe(set.origin);
  });

  test('may keep all or none', () => {
    expect(filterSplats(set, () => true)).toEqual(set);
    expect(filterSplats(set, () => false)).toMatchObject({ count: 0, positions: new Float32Array() });
  });
});
