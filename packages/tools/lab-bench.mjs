// Runs the lab's benchmarks, which need a browser. Their runners are TypeScript, loaded by Vite.
import { join } from 'node:path';
import { ensureChromium, ensureInstalled, fail, install, isInstalled, repositoryRoot } from './setup.mjs';

const PEERS = 'apps/lab/peers';

/**
 * Builds the packages, runs the benchmark whose runner is at `path` below the peers' sources, and
 * exits.
 */
export async function runLabBench(path) {
  ensureInstalled();
  const executablePath = ensureChromium();
  const { build } = await import('./build.mjs');
  await build().catch((error) => fail(error.message));

  const { runnerImport } = await import('vite');
  const runner = join(repositoryRoot, 'apps/lab/src/peers', path);
  const { module } = await runnerImport(runner, { configFile: false, logLevel: 'error' });
  const folder = process.env.INIT_CWD ?? process.cwd();
  const peersInstallation = { isInstalled: () => isInstalled(PEERS), install: () => install(PEERS) };
  const surroundings = { executablePath, repositoryRoot, peersInstallation, folder };
  process.exit(await module.default(process.argv.slice(2), surroundings));
}
