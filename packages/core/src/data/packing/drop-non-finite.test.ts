import { expect, test } from 'vitest';
import { randomSplats } from '../../testing/random-splats.ts';
import type { DropReason, SplatSet } from '../splats/splat-set.ts';
import { dropNonFinite } from './drop-non-finite.ts';
import { packSet } from './pack-set.ts';

const BAD_VALUES = [Number.NaN, Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];

test('leaves a finite set as it is, the very same', () => {
  const set = randomSplats({ count: 100 });
  expect(dropNonFinite(set)).toBe(set);
});

test.each<[DropReason, (set: SplatSet) => Float32Array, number]>([
  ['non-finite-position', ({ positions }) => positions, 3],
  ['non-finite-scale', ({ logScales }) => logScales, 3],
  ['non-finite-rotation', ({ rotations }) => rotations, 4],
  ['non-finite-color', ({ colorDc }) => colorDc, 3],
  ['non-finite-color', ({ harmonics }) => harmonics.coefficients, 45],
])('counts rows of %s and keeps the others in their order', (reason, columnOf, width) => {
  for (const bad of BAD_VALUES) {
    // A flat splat.
    if (reason === 'non-finite-scale' && bad < 0) continue;
    const set = randomSplats({ count: 20 });
    columnOf(set)[7 * width + 1] = bad;
    columnOf(set)[11 * width] = bad;
    const kept = dropNonFinite({ ...set, dropped: { 'non-finite-scale': 5 } });
    expect(kept.count).toBe(18);
    expect(kept.dropped).toEqual({ 'non-finite-scale': 5, [reason]: reason === 'non-finite-scale' ? 7 : 2 });
    expect(Array.from(kept.fileIndices)).toEqual([
      0, 1, 2, 3, 4, 5, 6, 8, 9, 10, 12, 13, 14, 15, 16, 17, 18, 19,
    ]);
    expect(columnOf(kept)).toHaveLength(18 * width);
  }
});

test('a log scale may be −∞, which is packed as the least one', () => {
  const sets = [Number.NEGATIVE_INFINITY, -40].map((flat) => {
    const set = randomSplats({ count: 300 });
    for (let i = 0; i < 300; i += 3) set.logScales[3 * i + (i % 3)] = flat;
    return set;
  });
  expect(dropNonFinite(sets[0])).toBe(sets[0]);
  for (const geometryPrecision of ['packed', 'f32'] as const) {
    const [flat, least] = sets.map((set) => packSet(set, { geometryPrecision, shPrecision: 'f32' }));
    expect(flat).toEqual(least);
  }
});

test('an opacity may be infinite, but not NaN', () => {
  const set = randomSplats({ count: 3 });
  set.opacityLogits.set([Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY, Number.NaN]);
  const kept = dropNonFinite(set);
  expect(kept.count).toBe(2);
  expect(kept.dropped).toEqual({ 'non-finite-opacity': 1 });
});
