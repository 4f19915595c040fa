import * as core from '@websplatter/core';
import * as three from '@websplatter/three';
import { expect, it } from 'vitest';
import * as react from './index.ts';

/** Classes of errors among exports, by name. */
function errorsOf(exports: object): Readonly<Record<string, unknown>> {
  const isError = (value: unknown) =>
    typeof value === 'function' &&
    (value === core.WebSplatterError || value.prototype instanceof core.WebSplatterError);
  return Object.fromEntries(Object.entries(exports).filter(([, value]) => isError(value)));
}

it('exports all errors of core and three, as three does those of core', () => {
  expect(Object.keys(errorsOf(core))).toContain('InvalidArgumentError');
  expect(errorsOf(three)).toMatchObject(errorsOf(core));
  expect(errorsOf(react)).toEqual(errorsOf(three));
});
