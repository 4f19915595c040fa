import { expect, test } from 'vitest';
import { InvalidArgumentError } from '../errors.ts';
import { type AccuracyRequest, checkAccuracy, internTarget, isAccuracyTarget } from './accuracy-target.ts';

test('distinguishes targets from settings', () => {
  for (const target of [{ minPsnrDb: 45 }, { maxFrameMs: 8 }]) expect(isAccuracyTarget(target)).toBe(true);
  for (const settings of ['fast', {}, { preset: 'high', sortKeyBits: 16 }] as AccuracyRequest[]) {
    expect(isAccuracyTarget(settings)).toBe(false);
    expect(internTarget(settings)).toBeNull();
  }
});

test('equal targets are the same object, even if the caller changes the original', () => {
  const own = { minPsnrDb: 45 };
  const target = internTarget(own);
  own.minPsnrDb = 10;
  expect(target).toEqual({ minPsnrDb: 45 });
  expect(internTarget({ minPsnrDb: 45 })).toBe(target);
  expect(internTarget(target!)).toBe(target);
  expect(internTarget({ maxFrameMs: 45 })).not.toBe(target);
});

/**
 * @fault Arguments: a target that is not finite
 * @consequence `InvalidArgumentError`
 */
test('rejects values that are not positive, finite numbers, and settings next to a target', () => {
  const refused = [
    { minPsnrDb: 0 },
    { maxFrameMs: Number.NaN },
    { minPsnrDb: Number.POSITIVE_INFINITY },
    { minPsnrDb: '45' },
  ];
  for (const target of [...refused, { minPsnrDb: 45, maxFrameMs: 8 }, { minPsnrDb: 45, preset: 'high' }])
    expect(() => internTarget(target as never), JSON.stringify(target)).toThrow(InvalidArgumentError);
});

test('checks requests: returns settings, null for a target, and names the accuracy and what was found in it', () => {
  expect(checkAccuracy({ preset: 'fast', sortKeyBits: 32 })).toMatchObject({ sortKeyBits: 32 });
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
  // @ts-expect-error: so is a target with settings.
  expect(() => checkAccuracy({ preset: 'high', minPsnrDb: 45 })).toThrow(InvalidArgumentError);
  expect(() => checkAccuracy('best' as never)).toThrow(InvalidArgumentError);
});
