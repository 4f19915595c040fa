import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { commitOf } from './commit.ts';

/** Facts of a built app about itself. */
export interface BuildFacts {
  /** Of `@websplatter/core`. */
  readonly version: string;
  /** Of the working copy. */
  readonly commit: string | null;
}

const repositoryRoot = fileURLToPath(new URL('../../..', import.meta.url));

/** For `define` in an app's configuration: `WEBSPLATTER_BUILD` is the `BuildFacts` in its code. */
export function definedBuildFacts(): { readonly WEBSPLATTER_BUILD: string } {
  const { version } = JSON.parse(readFileSync(`${repositoryRoot}/packages/core/package.json`, 'utf8'));
  return {
    WEBSPLATTER_BUILD: JSON.stringify({ version, commit: commitOf(repositoryRoot) } satisfies BuildFacts),
  };
}
