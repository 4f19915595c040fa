// `npm run bench:peers`: this project beside other renderers, in one browser; see apps/lab. The
// runner is TypeScript, which Vite loads.
import { join } from 'node:path';
import { ensureChromium, ensureInstalled, fail, install, isInstalled, repositoryRoot } from './setup.mjs';

const PEERS = 'apps/lab/peers';

ensureInstalled();
const executablePath = ensureChromium();
const { build } = await import('./build.mjs');
await build().catch((error) => fail(error.message));

const { runnerImport } = await import('vite');
const runner = join(repositoryRoot, 'apps/lab/src/peers/runner/main.ts');
const { module } = await runnerImport(runner, { configFile: false, logLevel: 'error' });
const folder = process.env.INIT_CWD ?? process.cwd();
const peersInstallation = { isInstalled: () => isInstalled(PEERS), install: () => install(PEERS) };
const surroundings = { executablePath, repositoryRoot, peersInstallation, folder };
process.exit(await module.benchPeers(process.argv.slice(2), surroundings));
