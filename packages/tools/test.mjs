// `npm test`: sets up a fresh clone, then runs all tests. `--full` (npm run test:full) adds the slow ones;
// other arguments go to Vitest, e.g. `npm test -- packages/cli`.
import { join } from 'node:path';
import { runTool } from './run-tool.mjs';
import { ensureChromium, ensureInstalled, ensureSecondWebGpu, fail, repositoryRoot } from './setup.mjs';

ensureInstalled();
const chromiumPath = ensureChromium();
const hasSecondWebGpu = ensureSecondWebGpu();
const { build } = await import('./build.mjs');
await build().catch((error) => fail(error.message));

const args = process.argv.slice(2).filter((arg) => arg !== '--full');
const env = { ...process.env, CHROMIUM_PATH: chromiumPath, WEBSPLATTER_REQUIRE_GPU: '1' };
if (hasSecondWebGpu) env.WEBSPLATTER_REQUIRE_SECOND_WEBGPU = '1';
if (process.argv.includes('--full')) env.WEBSPLATTER_FULL = '1';
const vitest = join(repositoryRoot, 'node_modules/vitest/vitest.mjs');
const { status } = await runTool(vitest, ['run', ...args], { cwd: repositoryRoot, env });
process.exit(status ?? 1);
