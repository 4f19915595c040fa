import { cp, writeFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { dirname, join, relative } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'vite';
import type { Bench, CommonOptions } from './bench-definition.ts';
import { buildPages } from './build-pages.ts';
import { PAGES_FOLDER, PAGES_LIST } from './pack-layout.ts';
import type { ChosenPeer } from './peer-list.ts';

const runnerFolder = fileURLToPath(new URL('.', import.meta.url));
/** Parts of playwright-core that no run needs, two thirds of it: its own tools, and types. */
const NOT_NEEDED = ['lib/vite', 'types'];

/**
 * Writes a bench into `folder` that needs only Node and a Chromium: no npm, no sources, no network.
 *
 * @throws BenchError if an adapter does not exist.
 */
export async function writePack<Options extends CommonOptions>(
  { script, packedMain }: Bench<Options>,
  peers: readonly ChosenPeer[],
  folder: string,
  commit: string | null,
  say: (line: string) => void,
): Promise<void> {
  await build({
    configFile: false,
    root: runnerFolder,
    logLevel: 'error',
    ssr: { noExternal: true, external: ['playwright-core'] },
    build: {
      ssr: true,
      target: 'es2022',
      outDir: folder,
      emptyOutDir: false,
      rolldownOptions: {
        input: {
          [`${script.replace(':', '-')}.mjs`]: join(runnerFolder, '..', packedMain),
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
