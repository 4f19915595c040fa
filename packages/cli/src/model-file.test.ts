import { expect, test } from 'vitest';
import { parseModel } from './render.ts';

const MOVED = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1];

test('a model matrix is an array or an object with one', () => {
  expect(parseModel(MOVED, 'm.json')).toEqual(Float64Array.from(MOVED));
  expect(parseModel({ matrix: MOVED }, 'm.json')).toEqual(Float64Array.from(MOVED));
});

test.each([
  [[1, 2, 3], 'm.json: a model matrix is 16 finite numbers, column-major, found [1, 2, 3]'],
  [
    { elements: MOVED },
    'm.json: a model matrix is 16 finite numbers, column-major, found nothing (field matrix)',
  ],
  [[...MOVED.slice(0, 15), null], /^m\.json: a model matrix is 16 finite numbers/],
  [
    [1, 0, 0, 7, 0, 1, 0, 8, 0, 0, 1, 9, 0, 0, 0, 1],
    /^m\.json: the last row must be 0, 0, 0, 1, found 7, 8, 9, 1; is .* row-major/,
  ],
])('%j is refused', (json, message) => {
  expect(() => parseModel(json, 'm.json')).toThrow(message);
});
