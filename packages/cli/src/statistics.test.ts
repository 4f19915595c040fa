import { expect, test } from 'vitest';
import { spreadOf } from './statistics.ts';

test('median and 99th percentile', () => {
  expect(spreadOf([3, 1, 2])).toEqual({ median: 2, p99: 3 });
  expect(spreadOf([4, 1, 2, 3])).toEqual({ median: 2.5, p99: 4 });
  expect(spreadOf(Array.from({ length: 200 }, (_, i) => i + 1))).toEqual({ median: 100.5, p99: 198 });
});

test('values that are not numbers have no spread', () => {
  expect(spreadOf([])).toBeNull();
  expect(spreadOf([Number.NaN, Number.NaN])).toBeNull();
});
