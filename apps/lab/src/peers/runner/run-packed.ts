import { readFile } from 'node:fs/promises';
import { basename, dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import type { Bench, CommonOptions } from './bench-definition.ts';
import { BenchError } from './bench-error.ts';
import { type BuiltPages, chooseBuilt } from './built-pages.ts';
import { PAGES_FOLDER, PAGES_LIST } from './pack-layout.ts';
import { runCommand } from './run-command.ts';

/**
 * Runs a bench in the folder that `--pack` wrote; returns the process's exit status.
 *
 * @param programUrl of the file that was started.
 */
export function runPacked<Options extends CommonOptions>(
  bench: Bench<Options>,
  programUrl: string,
): Promise<number> {
  const program = fileURLToPath(programUrl);
  const packFolder = dirname(program);
  const args = process.argv.slice(2);
  const commandLine = { name: `node ${basename(program)}`, args, usage: bench.usage };
  return runCommand(commandLine, async ({ workFolder, say }) => {
    const options = bench.readOptions(args, process.cwd());
    if (options.packFolder) throw new BenchError('--pack: what is packed cannot pack; it takes a checkout.');
    const executablePath = process.env.CHROMIUM_PATH;
    if (!executablePath) throw new BenchError('Set CHROMIUM_PATH to the program of a Chromium.');
    const pages: BuiltPages = JSON.parse(await readFile(join(packFolder, PAGES_LIST), 'utf8'));
    const pagesFolder = join(packFolder, PAGES_FOLDER);
    const setup = { executablePath, commandLine, pages, pagesFolder, workFolder, say };
    return bench.measure(options, chooseBuilt(options.peers, pages.peers), setup);
  });
}
