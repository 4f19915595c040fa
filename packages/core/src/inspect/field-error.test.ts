import { expect, test } from 'vitest';
import { describeFieldError, FieldErrors } from './field-error.ts';

const place = (splatIndex: number) => ({ cloudIndex: 0, splatIndex });

test('keeps the largest error relative to its bound, and the first beyond its bound', () => {
  const errors = new FieldErrors<'x' | 'y'>();
  errors.add(place(0), 'x', 1.5, 1, 1);
  errors.add(place(1), 'x', 11, 10, 10);
  expect(errors.worst.x).toMatchObject({ splatIndex: 0, error: 0.5, bound: 1, ratio: 0.5 });
  expect(errors.firstBad).toBeNull();
  errors.add(place(2), 'y', 3, 1, 1);
  errors.add(place(3), 'y', 9, 1, 1);
  expect(errors.worst.y).toMatchObject({ splatIndex: 3, ratio: 8 });
  expect(errors.firstBad).toMatchObject({ splatIndex: 2, got: 3, expected: 1 });
  expect(errors.badCount).toBe(2);
  expect(describeFieldError(errors.firstBad!)).toBe('cloud 0, splat 2, y: got 3, expected 1 ± 1');
});

test('no bound permits a non-finite value', () => {
  for (const got of [Number.NaN, Number.POSITIVE_INFINITY]) {
    const errors = new FieldErrors<'x'>();
    errors.add(place(0), 'x', got, 1, Number.POSITIVE_INFINITY);
    expect(errors.firstBad?.ratio).toBe(Number.POSITIVE_INFINITY);
  }
});

test('a bound of 0 permits only the expected number', () => {
  const errors = new FieldErrors<'x'>();
  errors.add(place(0), 'x', 2, 2, 0);
  expect(errors.worst.x?.ratio).toBe(0);
  errors.add(place(1), 'x', 2, 2 + 1e-12, 0);
  expect(errors.firstBad?.splatIndex).toBe(1);
});

test('an unbounded field is never bad as long as it is finite', () => {
  const errors = new FieldErrors<'x'>();
  errors.add(place(0), 'x', 7, 2, Number.POSITIVE_INFINITY);
  expect([errors.firstBad, errors.worst.x?.ratio]).toEqual([null, 0]);
});
