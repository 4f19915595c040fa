import { expect, test } from 'vitest';
import { InvalidArgumentError } from '../errors.ts';
import { type AccuracyRequest, checkAccuracy, internWish, isAccuracyWish } from './accuracy-wish.ts';

test('distinguishes wishes from settings', () => {
  for (const wish of [{ minPsnrDb: 45 }, { maxFrameMs: 8 }]) expect(isAccuracyWish(wish)).toBe(true);
  for (const settings of ['fast', {}, { preset: 'high', shDegree: 1 }] as AccuracyRequest[]) {
    expect(isAccuracyWish(settings)).toBe(false);
    expect(internWish(settings)).toBeNull();
  }
});

test('equal wishes are the same object, even if the caller changes the original', () => {
  const own = { minPsnrDb: 45 };
  const wish = internWish(own);
  own.minPsnrDb = 10;
  expect(wish).toEqual({ minPsnrDb: 45 });
  expect(internWish({ minPsnrDb: 45 })).toBe(wish);
  expect(internWish(wish!)).toBe(wish);
  expect(internWish({ maxFrameMs: 45 })).not.toBe(wish);
});

test('rejects values that are not positive, finite numbers, and settings next to a wish', () => {
  const refused = [
    { minPsnrDb: 0 },
    { maxFrameMs: Number.NaN },
    { minPsnrDb: Number.POSITIVE_INFINITY },
    { minPsnrDb: '45' },
  ];
  for (const wish of [...refused, { minPsnrDb: 45, maxFrameMs: 8 }, { minPsnrDb: 45, preset: 'high' }])
    expect(() => internWish(wish as never), JSON.stringify(wish)).toThrow(InvalidArgumentError);
});

test('checks requests: returns settings, null for a wish, and names the accuracy and what was found in it', () => {
  expect(checkAccuracy({ preset: 'fast', shDegree: 1 })).toMatchObject({ shDegree: 1 });
  expect(checkAccuracy({ maxFrameMs: 8 })).toBeNull();
  const both = { minPsnrDb: 45, maxFrameMs: 8 };
  // @ts-expect-error: the types refuse it, too.
  const check = () => checkAccuracy(both);
  expect(check).toThrow(
    expect.objectContaining({
      argument: 'accuracy',
      message: expect.stringContaining('The accuracy is { minPsnrDb: 45, maxFrameMs: 8 }'),
    }),
  );
  // @ts-expect-error: so is a wish with settings.
  expect(() => checkAccuracy({ preset: 'high', minPsnrDb: 45 })).toThrow(InvalidArgumentError);
  expect(() => checkAccuracy('best' as never)).toThrow(InvalidArgumentError);
});
