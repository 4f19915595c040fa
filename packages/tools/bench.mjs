// `npm run bench:peers`, `bench:streams` and `bench:levels`: benches of the lab, see apps/lab. Their
// runner is TypeScript, which Vite loads with the bench of the kind in the first argument.
import { join } from 'node:path';
import { ensureChromium, ensureInstalled, fail, install, isInstalled, repositoryRoot } from './setup.mjs';

const PEERS = 'apps/lab/peers';
/** Kinds by whether they open pages in a browser; others need the peers' packages in Node. */
const KINDS = { frames: true, streams: true, levels: false };

const [kind, ...args] = process.argv.slice(2);
if (!Object.hasOwn(KINDS, kind)) fail(`“${kind}” is no bench. There are ${Object.keys(KINDS).join(', ')}.`);
ensureInstalled(...(KINDS[kind] ? [] : [PEERS]));
const executablePath = KINDS[kind] ? ensureChromium() : null;
const { build } = await import('./build.mjs');
await build().catch((error) => fail(error.message));

const { runnerImport } = await import('vite');
const sources = join(repositoryRoot, 'apps/lab/src/peers');
const benchPath = join(sources, kind, 'bench.ts');
const { module } = await runnerImport(join(sources, 'runner/main.ts'), {
  configFile: false,
  logLevel: 'error',
  resolve: { alias: { 'virtual:bench': benchPath } },
});
const folder = process.env.INIT_CWD ?? process.cwd();
const peersInstallation = { isInstalled: () => isInstalled(PEERS), install: () => install(PEERS) };
const surroundings = { executablePath, repositoryRoot, peersInstallation, folder, benchPath };
process.exit(await module.default(args, surroundings));
