// `npm run bench:levels`: levels of detail beside those of other projects, without a browser; see
// apps/lab. The runner is TypeScript, which Vite loads.
import { join } from 'node:path';
import { ensureInstalled, fail, repositoryRoot } from './setup.mjs';

ensureInstalled('apps/lab/peers');
const { build } = await import('./build.mjs');
await build().catch((error) => fail(error.message));

const { runnerImport } = await import('vite');
const runner = join(repositoryRoot, 'apps/lab/src/peers/levels/main.ts');
const { module } = await runnerImport(runner, { configFile: false, logLevel: 'error' });
process.exit(await module.benchLevels(process.argv.slice(2), process.env.INIT_CWD ?? process.cwd()));
