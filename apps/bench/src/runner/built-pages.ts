import { existsSync } from 'node:fs';
import { mkdir, readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { BenchError } from './bench-error.ts';
import { buildPage } from './build-page.ts';
import { type ChosenPeer, choosePeers } from './peer-list.ts';

/** A peer whose page is built. */
export interface BuiltPeer {
  readonly name: string;
  readonly isFloor: boolean;
  /** Null where the peer is no package. */
  readonly version: string | null;
  /** Address of its page from the root of all pages, options included. */
  readonly page: string;
}

/** The pages of a bench, which need neither packages nor sources. */
export interface BuiltPages {
  /** Of the checkout that they were built from; null outside of git. */
  readonly commit: string | null;
  /** Draws nothing: tells the ways of waiting apart. */
  readonly floor: BuiltPeer;
  readonly peers: readonly BuiltPeer[];
}

/** File at the root of all pages, without anything in it. */
export const BLANK_PAGE = 'blank.html';

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
    const { name, isFloor, adapterPath, options, packageFile } = peer;
    if (!existsSync(adapterPath)) throw new BenchError(`--peers: ${adapterPath} does not exist.`);
    if (!subfolders.has(adapterPath)) {
      const subfolder = `page-${subfolders.size}`;
      subfolders.set(adapterPath, subfolder);
      say(`Building the page of ${name} …`);
      await buildPage(adapterPath, join(folder, subfolder));
    }
    const version = packageFile && JSON.parse(await readFile(packageFile, 'utf8')).version;
    return { name, isFloor, version, page: `${subfolders.get(adapterPath)}/index.html?${options}` };
  };
  const [floor] = choosePeers('floor-webgpu', folder);
  const pages = { commit, floor: await built(floor), peers: [] as BuiltPeer[] };
  for (const peer of peers) pages.peers.push(await built(peer));
  return pages;
}

/**
 * Those of the built `peers` that `text` names: `NAME`, `NAME?OPTIONS`, or `all`.
 *
 * @throws BenchError for a name that is not among them.
 */
export function chooseBuilt(text: string, peers: readonly BuiltPeer[]): BuiltPeer[] {
  if (text === 'all') return [...peers];
  return text.split(',').map((word) => {
    const same = peers.find(({ name }) => name === word);
    if (same) return same;
    const [, base, options] = /^([^?]+)\?(.+)$/.exec(word) ?? [];
    const peer = peers.find(({ name }) => name === base);
    if (!peer)
      throw new BenchError(
        `--peers has "${word}"; this pack has ${peers.map(({ name }) => name).join(', ')}.`,
      );
    const separator = peer.page.endsWith('?') ? '' : '&';
    return { ...peer, name: word, page: `${peer.page}${separator}${options}` };
  });
}
