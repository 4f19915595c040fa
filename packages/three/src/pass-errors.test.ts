import { expect, test } from 'vitest';
import { SplatsPassError } from './errors.ts';
import { passError } from './pass-errors.ts';

test.each([
  ['several-cameras', /ArrayCamera.*Render each camera/],
  ['lost-samples', /storeMultisampledColorBuffer/],
  ['unresolved-samples', /resolveColorBuffer/],
  ['part-of-texture', /mip level/],
] as const)('the error for %s says what to do', (reason, advice) => {
  const error = passError(reason);
  expect(error).toBeInstanceOf(SplatsPassError);
  expect(error.message).toMatch(advice);
});
