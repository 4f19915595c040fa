import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { commitOf } from './commit.ts';

/** Facts about the build of an app. */
export interface BuildFacts {
  /** Version of `@websplatter/core`. */
  readonly version: string;
  /** Commit of the working copy; null outside of git. */
  readonly commit: string | null;
}

const repositoryRoot = fileURLToPath(new URL('../../..', import.meta.url));

/** For `define` in an app's configuration: defines `WEBSPLATTER_BUILD` as the `BuildFacts`. */
export function definedBuildFacts(): { readonly WEBSPLATTER_BUILD: string } {
  const { version } = JSON.parse(readFileSync(`${repositoryRoot}/packages/core/package.json`, 'utf8'));
  return {
    WEBSPLATTER_BUILD: JSON.stringify({ version, commit: commitOf(repositoryRoot) } satisfies BuildFacts),
  };
}
