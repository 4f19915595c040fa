import { execFileSync } from 'node:child_process';

/**
 * Commit of `folder`'s working copy, with `+changes` if files differ from it; null outside of git.
 */
export function commitOf(folder: string): string | null {
  const git = (...args: string[]) =>
    execFileSync('git', args, { cwd: folder, encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] }).trim();
  try {
    const commit = git('rev-parse', 'HEAD');
    return git('status', '--porcelain', '--untracked-files=no') === '' ? commit : `${commit}+changes`;
  } catch {
    // The folder is outside of git.
    return null;
  }
}
