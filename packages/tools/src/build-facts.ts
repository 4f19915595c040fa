import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

/** What an app that is built says about itself. */
export interface BuildFacts {
  /** Of `@websplatter/core`. */
  readonly version: string;
  /** Of the working copy, with `+changes` if files differ, as in the command line's reports; null outside of git. */
  readonly commit: string | null;
}

const repositoryRoot = fileURLToPath(new URL('../../..', import.meta.url));

/** For `define` in an app's configuration: `WEBSPLATTER_BUILD` stands for the `BuildFacts` in its code. */
export function definedBuildFacts(): { readonly WEBSPLATTER_BUILD: string } {
  const { version } = JSON.parse(readFileSync(`${repositoryRoot}/packages/core/package.json`, 'utf8'));
  return { WEBSPLATTER_BUILD: JSON.stringify({ version, commit: currentCommit() } satisfies BuildFacts) };
}

function currentCommit(): string | null {
  const git = (...args: string[]) =>
    execFileSync('git', args, {
      cwd: repositoryRoot,
      encoding: 'utf8',
      stdio: ['ignore', 'pipe', 'ignore'],
    }).trim();
  try {
    const commit = git('rev-parse', 'HEAD');
    return git('status', '--porcelain', '--untracked-files=no') === '' ? commit : `${commit}+changes`;
  } catch {
    return null;
  }
}
