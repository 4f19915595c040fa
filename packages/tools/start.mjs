// `npm start`: from a fresh clone to the running viewer. Arguments go to Vite, e.g. `npm start -- --port 4000 --host`.
import { join } from 'node:path';
import { runTool } from './run-tool.mjs';
import { ensureInstalled, fail, repositoryRoot } from './setup.mjs';

ensureInstalled();
const { build } = await import('./build.mjs');
await build().catch((error) => fail(error.message));

const args = process.argv.slice(2);
const hasScreen = process.platform !== 'linux' || Boolean(process.env.DISPLAY || process.env.WAYLAND_DISPLAY);
if (hasScreen && !process.env.CI && !args.some((arg) => arg.startsWith('--open'))) args.push('--open');
const vite = join(repositoryRoot, 'node_modules/vite/bin/vite.js');
const { status, wasAskedToEnd } = await runTool(vite, args, { cwd: join(repositoryRoot, 'apps/viewer') });
process.exit(wasAskedToEnd ? 0 : (status ?? 1));
