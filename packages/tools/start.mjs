// `npm start`: starts the viewer, even from a fresh clone. `npm start -- examples` starts the
// examples for react-three-fiber. `npm start -- lab` starts the lab, which the viewer's server also
// serves at lab/. Other arguments are passed to Vite, e.g. `npm start -- --port 4000`.
import { join } from 'node:path';
import { runTool } from './run-tool.mjs';
import { ensureInstalled, fail, repositoryRoot } from './setup.mjs';

const args = process.argv.slice(2);
const app = args[0] === undefined || args[0].startsWith('-') ? 'viewer' : args.shift();
const folder = { viewer: 'apps/viewer', lab: 'apps/viewer', examples: 'apps/examples' }[app];
if (!folder) fail(`There is no app “${app}”: start the viewer (no name), examples or lab.`);

ensureInstalled(...(app === 'examples' ? ['apps/examples'] : []));

const hasScreen = process.platform !== 'linux' || Boolean(process.env.DISPLAY || process.env.WAYLAND_DISPLAY);
if (hasScreen && !process.env.CI && !args.some((arg) => arg.startsWith('--open')))
  args.push('--open', app === 'lab' ? '/lab/' : '/');
const vite = join(repositoryRoot, 'node_modules/vite/bin/vite.js');
if (app === 'lab') console.log('The lab is at lab/ below the address that follows.');
const { status, wasAskedToEnd } = await runTool(vite, args, { cwd: join(repositoryRoot, folder) });
process.exit(wasAskedToEnd ? 0 : (status ?? 1));
