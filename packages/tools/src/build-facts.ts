import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { commitOf } from './commit.ts';

/** What an app that is built says about itself. */
export interface BuildFacts {
  /** Of `@websplatter/core`. */
  readonly version: string;
  /** Of the working copy. */
  readonly commit: string | null;
}

const repositoryRoot = fileURLToPath(new URL('../../..', import.meta.url));

/** For `define` in an app's configuration: `WEBSPLATTER_BUILD` stands for the `BuildFacts` in its code. */
export function definedBuildFacts(): { readonly WEBSPLATTER_BUILD: string } {
  const { version } = JSON.parse(readFileSync(`${repositoryRoot}/packages/core/package.json`, 'utf8'));
  return {
    WEBSPLATTER_BUILD: JSON.stringify({ version, commit: commitOf(repositoryRoot) } satisfies BuildFacts),
  };
}
