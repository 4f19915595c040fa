// `npm start`: starts the viewer, even from a fresh clone; `npm start -- examples` the examples for react-three-fiber, and
// `npm start -- conformance` the page that runs the hard cases. Other arguments go to Vite, e.g. `npm start -- --port 4000 --host`.
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { runTool } from './run-tool.mjs';
import { ensureInstalled, fail, repositoryRoot } from './setup.mjs';

const args = process.argv.slice(2);
const app = args[0] === undefined || args[0].startsWith('-') ? 'viewer' : args.shift();
const folder = join(repositoryRoot, 'apps', app);
if (!existsSync(folder))
  fail(`There is no app “${app}”: start the viewer (no name), examples or conformance.`);

ensureInstalled(...(app === 'examples' ? ['apps/examples'] : []));

const hasScreen = process.platform !== 'linux' || Boolean(process.env.DISPLAY || process.env.WAYLAND_DISPLAY);
if (hasScreen && !process.env.CI && !args.some((arg) => arg.startsWith('--open'))) args.push('--open');
const vite = join(repositoryRoot, 'node_modules/vite/bin/vite.js');
const { status, wasAskedToEnd } = await runTool(vite, args, { cwd: folder });
process.exit(wasAskedToEnd ? 0 : (status ?? 1));
