import { expect, it } from 'vitest';
import { selectValue } from './select-value.ts';

const COUNT = 501;
const arrangements: Readonly<Record<string, (i: number) => number>> = {
  'in order': (i) => i,
  'in reverse': (i) => -i,
  'all equal': () => 7,
  'of few kinds': (i) => (i * 7919) % 3,
  scattered: (i) => Math.fround(Math.sin(i * i) * 10 ** (i % 7)),
  'infinite in part': (i) => (i % 2 ? i : (i % 4 ? 1 : -1) * Number.POSITIVE_INFINITY),
};

it.each(Object.keys(arrangements))('finds what sorting would put at a place, of values %s', (name) => {
  const values = Float32Array.from({ length: COUNT }, (_, i) => arrangements[name](i));
  const sorted = values.toSorted();
  for (const place of [0, 1, 10, 250, 490, 499, 500]) {
    expect(selectValue(values.slice(), place)).toBe(sorted[place]);
  }
  // Reordered, they are still the same values.
  selectValue(values, 250);
  expect(values.toSorted()).toEqual(sorted);
});

it('finds the only value', () => {
  expect(selectValue(new Float32Array([3]), 0)).toBe(3);
});
