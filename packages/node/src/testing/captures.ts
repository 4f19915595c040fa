import { existsSync } from 'node:fs';
import { resolve } from 'node:path';

/** The folder of real captures; the tests of captures are in `describe.runIf(captures)`. */
export const captures = process.env.WEBSPLATTER_CAPTURES;

/** @throws Error if the folder has no such file: missing captures must fail, not skip, a test. */
export function capturePath(name: string, folder = captures ?? ''): string {
  const path = resolve(folder, name);
  if (existsSync(path)) return path;
  throw new Error(
    `There is no ${name} in ${resolve(folder)}, the folder that WEBSPLATTER_CAPTURES names; put it there, or unset the variable.`,
  );
}
