// `node bench-peers.mjs` and `node bench-streams.mjs` in a folder that `--pack` wrote.
import { readFile } from 'node:fs/promises';
import { basename, dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import bench from 'virtual:bench';
import { runCommand } from './bench.ts';
import { BenchError } from './bench-error.ts';
import { type BuiltPages, chooseBuilt, PAGES_FOLDER, PAGES_LIST } from './built-pages.ts';

if (!('choose' in bench)) throw new Error('Only benches of pages can be packed.');
const { usage, readOptions, measure } = bench;
const program = fileURLToPath(import.meta.url);
const packFolder = dirname(program);
const args = process.argv.slice(2);
const commandLine = { name: `node ${basename(program)}`, args, usage };

process.exitCode = await runCommand(commandLine, async (run) => {
  const options = readOptions(args, process.cwd());
  if (options.packFolder) throw new BenchError('--pack: what is packed cannot pack; it takes a checkout.');
  const executablePath = process.env.CHROMIUM_PATH;
  if (!executablePath) throw new BenchError('Set CHROMIUM_PATH to the program of a Chromium.');
  const pages: BuiltPages = JSON.parse(await readFile(join(packFolder, PAGES_LIST), 'utf8'));
  const pagesFolder = join(packFolder, PAGES_FOLDER);
  const setup = { ...run, executablePath, pages, pagesFolder };
  return measure(options, chooseBuilt(options.peers, pages.peers), setup);
});
