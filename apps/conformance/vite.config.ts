import { execFileSync } from 'node:child_process';
import { fileURLToPath } from 'node:url';
import { defaultClientConditions, defineConfig } from 'vite';
import corePackage from '../../packages/core/package.json' with { type: 'json' };

const repositoryRoot = fileURLToPath(new URL('../..', import.meta.url));

/** Commit of the working copy, with `+changes` if files differ, as in the command line's reports; null outside of git. */
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

export default defineConfig({
  root: fileURLToPath(new URL('.', import.meta.url)),
  // Works below any path of a web server.
  base: './',
  // The packages run from their sources, so that editing them reloads the page.
  resolve: { conditions: ['@websplatter/source', ...defaultClientConditions] },
  define: {
    WEBSPLATTER_BUILD: JSON.stringify({ version: corePackage.version, commit: currentCommit() }),
  },
  worker: { format: 'es' },
  server: { fs: { allow: [repositoryRoot] } },
  build: { target: 'es2022' },
});
