import { existsSync } from 'node:fs';
import { mkdir, readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { commitOf } from '@websplatter/tools/commit';
import { build } from 'vite';
import { BenchError } from './bench-error.ts';
import { BLANK_PAGE, type BuiltPages, type BuiltPeer } from './built-pages.ts';
import { type ChosenPeer, choosePeers, type PeerSource } from './peer-list.ts';

const labFolder = fileURLToPath(new URL('../../..', import.meta.url));
const PAGE = 'peer.html';

/**
 * Builds the pages of `peers` into `folder`, one per adapter.
 *
 * @throws BenchError if an adapter does not exist.
 */
export async function buildPages(
  peers: readonly ChosenPeer[],
  folder: string,
  commit: string | null,
  say: (line: string) => void,
): Promise<BuiltPages> {
  await mkdir(folder, { recursive: true });
  await writeFile(join(folder, BLANK_PAGE), '');
  const subfolders = new Map<string, string>();
  const built = async (peer: ChosenPeer): Promise<BuiltPeer> => {
    const { name, isFloor, adapterPath, options, packageFile, source } = peer;
    if (!existsSync(adapterPath)) throw new BenchError(`--peers: ${adapterPath} does not exist.`);
    if (!subfolders.has(adapterPath)) {
      const subfolder = `page-${subfolders.size}`;
      subfolders.set(adapterPath, subfolder);
      say(`Building the page of ${name} …`);
      await buildPage(adapterPath, source, join(folder, subfolder));
    }
    // Git takes a folder unpacked within this working copy for a part of it, and gives its commit.
    const isClone = source && existsSync(join(source.folder, '.git'));
    const commitOfClone = (isClone && commitOf(source.folder)?.slice(0, 12)) || null;
    const version = packageFile ? JSON.parse(await readFile(packageFile, 'utf8')).version : commitOfClone;
    return { name, isFloor, version, page: `${subfolders.get(adapterPath)}/${PAGE}?${options}` };
  };
  const [floor] = choosePeers('floor-webgpu', folder);
  const pages = { commit, floor: await built(floor), peers: [] as BuiltPeer[] };
  for (const peer of peers) pages.peers.push(await built(peer));
  return pages;
}

/** Builds one adapter's page into `outDir`, as it would be shipped, sharing no code with others. */
async function buildPage(adapterPath: string, source: PeerSource | null, outDir: string): Promise<void> {
  await build({
    configFile: false,
    root: labFolder,
    base: './',
    logLevel: 'error',
    resolve: {
      alias: { 'virtual:peer-adapter': adapterPath, ...(source && { 'peer-source': source.folder }) },
    },
    worker: { format: 'es' },
    build: {
      target: 'es2022',
      outDir,
      emptyOutDir: true,
      chunkSizeWarningLimit: 10_000,
      rolldownOptions: { input: join(labFolder, PAGE) },
    },
  });
}
