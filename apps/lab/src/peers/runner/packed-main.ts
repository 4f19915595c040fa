// `node bench-peers.mjs` in a folder that `--pack` wrote.
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { measurePeers } from './bench.ts';
import { BenchError } from './bench-error.ts';
import { type BuiltPages, chooseBuilt } from './built-pages.ts';
import { readOptions } from './options.ts';
import { PACK_COMMAND, PAGES_FOLDER, PAGES_LIST } from './pack-layout.ts';
import { runCommand } from './run-command.ts';

const packFolder = fileURLToPath(new URL('.', import.meta.url));
const commandLine = { name: `node ${PACK_COMMAND}`, args: process.argv.slice(2) };

process.exitCode = await runCommand(commandLine, async ({ workFolder, say }) => {
  const options = readOptions(commandLine.args, process.cwd());
  if (options.packFolder) throw new BenchError('--pack: what is packed cannot pack; it takes a checkout.');
  const executablePath = process.env.CHROMIUM_PATH;
  if (!executablePath) throw new BenchError('Set CHROMIUM_PATH to the program of a Chromium.');
  const pages: BuiltPages = JSON.parse(await readFile(join(packFolder, PAGES_LIST), 'utf8'));
  const pagesFolder = join(packFolder, PAGES_FOLDER);
  const setup = { executablePath, commandLine, pages, pagesFolder, workFolder, say };
  return { options, report: await measurePeers(options, chooseBuilt(options.peers, pages.peers), setup) };
});
