import { expect, test } from 'vitest';
import { boxAround, LabelSpace } from './label-space.ts';

const AREA = { left: 0, top: 0, right: 100, bottom: 50 };

test('a place is free inside the area, its edges included, beside what is taken', () => {
  const space = new LabelSpace(AREA, [boxAround(10, 10, 4)]);
  expect(space.conflict({ left: 14, top: 0, right: 100, bottom: 50 })).toBe(0);
  expect(space.conflict({ left: 0, top: 14, right: 14, bottom: 30 })).toBe(0);
});

test('the parts of a place that cover others or lie outside are added up', () => {
  const space = new LabelSpace(AREA, [boxAround(10, 10, 4)]);
  const place = { left: 8, top: -5, right: 28, bottom: 10 };
  const [outside, covered] = [20 * 5, 6 * 4];
  expect(space.conflict(place)).toBe(outside + covered);
  space.take({ left: 20, top: 0, right: 40, bottom: 10 });
  expect(space.conflict(place)).toBe(outside + covered + 8 * 10);
  expect(space.conflict({ left: 200, top: 0, right: 210, bottom: 10 })).toBe(100);
});
