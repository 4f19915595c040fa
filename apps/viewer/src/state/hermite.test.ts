import { expect, it } from 'vitest';
import { hermite } from './hermite.ts';

it('a cubic has the values and the slopes that it is given', () => {
  const at = (part: number) => hermite(2, -1, 5, 4, part);
  expect([at(0), at(1)]).toEqual([2, 5]);
  expect((at(1e-6) - at(0)) / 1e-6).toBeCloseTo(-1, 4);
  expect((at(1) - at(1 - 1e-6)) / 1e-6).toBeCloseTo(4, 4);
});
