// `npm test`: sets up a fresh clone, then runs the first tier of tests. `--full` (`npm run test:full`)
// runs all other tests, and random ones again with more inputs. Other arguments are passed to Vitest,
// e.g. `npm test -- packages/cli` or `npm run test:full -- --project full:viewer`. `--cost` also writes what
// each file and test costs in CPU seconds, and runs one test at a time for it.
import { mkdirSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { runSideBySide } from './run-side-by-side.mjs';
import { runTool } from './run-tool.mjs';
import { ensureChromium, ensureInstalled, ensureSecondWebGpu, fail, repositoryRoot } from './setup.mjs';

const isFull = process.argv.includes('--full');
const isMeasured = process.argv.includes('--cost');
const args = process.argv.slice(2).filter((arg) => arg !== '--full' && arg !== '--cost');

/** Projects of the full run besides the root; esbuild comes from npm's cache, which checks fill. */
const projects = isFull
  ? [
      'apps/docs',
      'apps/examples',
      'e2e/three/oldest',
      'packages/tools/package-checks',
      'packages/tools/second-webgpu',
    ]
  : [];
ensureInstalled(...projects);
const env = { ...process.env, CHROMIUM_PATH: ensureChromium(), WEBSPLATTER_REQUIRE_GPU: '1' };
if (isFull) {
  env.WEBSPLATTER_FULL = '1';
  if (ensureSecondWebGpu()) env.WEBSPLATTER_REQUIRE_SECOND_WEBGPU = '1';
}
const { build } = await import('./build.mjs');
// Tests of the first tier run the command line from its built files, and all else from sources.
await build(isFull ? undefined : 'cli').catch((error) => fail(error.message));

const costs = join(repositoryRoot, '.out', isFull ? 'costs-full' : 'costs');
if (isMeasured) {
  mkdirSync(join(repositoryRoot, '.out'), { recursive: true });
  rmSync(`${costs}.jsonl`, { force: true });
  Object.assign(env, {
    WEBSPLATTER_COSTS: `${costs}.jsonl`,
    WEBSPLATTER_COSTS_ROOT: String(process.pid),
    // Costs are told apart one test at a time.
    WEBSPLATTER_WORKERS: '1',
  });
}

const vitest = join(repositoryRoot, 'node_modules/vitest/vitest.mjs');
const options = { cwd: repositoryRoot, env };
let status;
if (isFull || isMeasured || args.length > 0) {
  const tier = args.includes('--project') ? [] : ['--project', isFull ? 'full:*' : '!full:*'];
  ({ status } = await runTool(vitest, ['run', ...tier, ...args], options));
} else {
  env.WEBSPLATTER_WORKERS = '1';
  status = await runSideBySide(vitest, options, [
    ['unit', 'unit-mocking'],
    ['gpu', 'gpu-apart', 'smoke'],
  ]);
}
if (isMeasured) {
  const { writeCostTable } = await import('./costs/cost-table.mjs');
  writeCostTable(`${costs}.jsonl`, `${costs}.txt`);
}
process.exit(status ?? 1);
