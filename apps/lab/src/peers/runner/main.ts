// `npm run bench:peers`, `bench:streams` and `bench:levels`, started by packages/tools/bench.mjs.
import { cp, writeFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { dirname, join, relative } from 'node:path';
import { fileURLToPath } from 'node:url';
import bench from 'virtual:bench';
import { commitOf } from '@websplatter/tools/commit';
import { build } from 'vite';
import { runCommand } from './bench.ts';
import { buildPages } from './build-pages.ts';
import { PAGES_FOLDER, PAGES_LIST } from './built-pages.ts';
import { type ChosenPeer, type PeersInstallation, withPackages } from './peer-list.ts';

export interface Surroundings {
  /** Chromium's program; null for a bench without pages. */
  readonly executablePath: string | null;
  readonly repositoryRoot: string;
  readonly peersInstallation: PeersInstallation;
  /** From where the command was called. */
  readonly folder: string;
  /** The file of the bench. */
  readonly benchPath: string;
}

/** Runs the bench of this checkout, or packs it; returns the process's exit status. */
export default function run(
  args: readonly string[],
  { executablePath, repositoryRoot, peersInstallation, folder, benchPath }: Surroundings,
): Promise<number> {
  const { script, usage } = bench;
  const commandLine = { name: `npm run ${script} --`, args, usage };
  return runCommand(commandLine, async (run) => {
    if (!('choose' in bench)) return bench.measure(bench.readOptions(args, folder), run);
    const { workFolder, say } = run;
    const options = bench.readOptions(args, folder);
    const peers = withPackages(bench.choose(options, folder), peersInstallation, options.installs, say);
    const commit = commitOf(repositoryRoot);
    if (options.packFolder) {
      await writePack(benchPath, peers, options.packFolder, commit, say);
      return null;
    }
    const pagesFolder = join(workFolder, 'pages');
    const pages = await buildPages(peers, pagesFolder, commit, say);
    const setup = { ...run, executablePath: executablePath!, pages, pagesFolder };
    return bench.measure(options, pages.peers, setup);
  });
}

const runnerFolder = fileURLToPath(new URL('.', import.meta.url));
/** Two thirds of playwright-core that no run needs: its own tools, and types. */
const NOT_NEEDED = ['lib/vite', 'types'];

/**
 * Writes the bench into `folder`, where it needs only Node and a Chromium: no npm, no sources, no
 * network.
 *
 * @throws BenchError if an adapter does not exist.
 */
async function writePack(
  benchPath: string,
  peers: readonly ChosenPeer[],
  folder: string,
  commit: string | null,
  say: (line: string) => void,
): Promise<void> {
  await build({
    configFile: false,
    root: runnerFolder,
    logLevel: 'error',
    resolve: { alias: { 'virtual:bench': benchPath } },
    ssr: { noExternal: true, external: ['playwright-core'] },
    build: {
      ssr: true,
      target: 'es2022',
      outDir: folder,
      emptyOutDir: false,
      rolldownOptions: {
        input: {
          [`${bench.script.replace(':', '-')}.mjs`]: join(runnerFolder, 'packed-main.ts'),
          'reference-worker.mjs': join(runnerFolder, 'reference-worker.mjs'),
        },
        // In one folder, as the threads' file is found beside the file that starts them.
        output: { entryFileNames: '[name]', chunkFileNames: '[name]-[hash].mjs' },
      },
    },
  });
  const pages = await buildPages(peers, join(folder, PAGES_FOLDER), commit, say);
  await writeFile(join(folder, PAGES_LIST), JSON.stringify(pages));
  const tools = createRequire(createRequire(import.meta.url).resolve('@websplatter/tools/browser'));
  const playwright = dirname(tools.resolve('playwright-core/package.json'));
  await cp(playwright, join(folder, 'node_modules/playwright-core'), {
    recursive: true,
    dereference: true,
    filter: (path) => !NOT_NEEDED.includes(relative(playwright, path)),
  });
}
