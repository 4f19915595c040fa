import { execFileSync } from 'node:child_process';
import { fileURLToPath } from 'node:url';
import { defaultClientConditions, defineConfig } from 'vite';
import packageJson from './package.json' with { type: 'json' };

const repositoryRoot = fileURLToPath(new URL('../..', import.meta.url));

/** Commit of the working copy, null outside of git. */
function currentCommit(): string | null {
  try {
    const text = execFileSync('git', ['rev-parse', 'HEAD'], {
      cwd: repositoryRoot,
      encoding: 'utf8',
      stdio: ['ignore', 'pipe', 'ignore'],
    });
    return text.trim();
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
    WEBSPLATTER_BUILD: JSON.stringify({ version: packageJson.version, commit: currentCommit() }),
  },
  worker: { format: 'es' },
  server: { fs: { allow: [repositoryRoot] } },
  build: { target: 'es2022' },
});
