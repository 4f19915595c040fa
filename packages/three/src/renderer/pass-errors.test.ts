import { expect, test } from 'vitest';
import { SplatsPassError } from '../errors.ts';
import { passError } from './pass-errors.ts';

test.each([
  ['layers-at-once', /Install three 0\.187/],
  ['unreadable-texture', /outputColorSpace/],
  ['many-cameras', /16 cameras.*16/],
  ['lost-samples', /storeMultisampledColorBuffer/],
  ['unresolved-samples', /resolveColorBuffer/],
  ['part-of-texture', /mip level/],
] as const)('the error for %s says what to do', (reason, advice) => {
  const error = passError(reason);
  expect(error).toBeInstanceOf(SplatsPassError);
  expect(error.message).toMatch(advice);
});
