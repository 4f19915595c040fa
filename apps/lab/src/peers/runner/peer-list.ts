import { isAbsolute, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { BenchError } from './bench-error.ts';

/** A peer that the bench knows by name. */
interface KnownPeer {
  readonly name: string;
  /** Path from apps/lab. */
  readonly adapter: string;
  /** For the adapter, as in an address. */
  readonly options?: string;
  /** Folder of the peer's package: below apps/lab/peers, which is installed on demand, or the repository's root. */
  readonly package?: { readonly at: 'peers' | 'root'; readonly folder: string };
  /** Draws nothing: shows what the measuring itself takes. */
  readonly isFloor?: true;
}

/** In the order in which they are measured. All are measured by default. */
const KNOWN_PEERS: readonly KnownPeer[] = [
  { name: 'floor-webgpu', adapter: 'src/peers/adapters/floor.ts', isFloor: true },
  { name: 'floor-webgl2', adapter: 'src/peers/adapters/floor.ts', options: 'api=webgl2', isFloor: true },
  { name: 'websplatter', adapter: 'src/peers/adapters/websplatter.ts' },
  { name: 'websplatter-three', adapter: 'src/peers/adapters/websplatter-three.ts' },
  {
    name: 'playcanvas',
    adapter: 'peers/playcanvas.js',
    package: { at: 'peers', folder: 'playcanvas' },
  },
  {
    name: 'playcanvas-compute',
    adapter: 'peers/playcanvas-compute.js',
    package: { at: 'peers', folder: 'playcanvas-2.19.7' },
  },
  { name: 'spark', adapter: 'peers/spark.js', package: { at: 'peers', folder: '@sparkjsdev/spark' } },
  { name: 'three', adapter: 'src/peers/adapters/three.ts', package: { at: 'root', folder: 'three' } },
  {
    name: 'mkkellogg',
    adapter: 'peers/mkkellogg.js',
    package: { at: 'peers', folder: '@mkkellogg/gaussian-splats-3d' },
  },
  { name: 'gsplat', adapter: 'peers/gsplat.js', package: { at: 'peers', folder: 'gsplat' } },
];

export const PEER_NAMES: readonly string[] = KNOWN_PEERS.map(({ name }) => name);

const labFolder = fileURLToPath(new URL('../../..', import.meta.url));
export const peersFolder = resolve(labFolder, 'peers');
const packageFolders = { peers: peersFolder, root: resolve(labFolder, '../..') };

/** A peer to measure. */
export interface ChosenPeer {
  /** As on the command line, options included; each is there once. */
  readonly name: string;
  readonly adapterPath: string;
  /** For the adapter, as in an address. */
  readonly options: string;
  readonly isFloor: boolean;
  /** Its package.json, where it is a package. */
  readonly packageFile: string | null;
  /** Whether its package is one of those that are installed on demand. */
  readonly isOnDemand: boolean;
}

/**
 * Reads names of peers: `NAME` of {@link PEER_NAMES}, `NAME=ADAPTER` with a path from `folder` for a peer of one's own, each
 * with `?OPTIONS` for its adapter at the end, or `all`.
 *
 * @throws BenchError for names that are unknown or double.
 */
export function choosePeers(text: string, folder: string): ChosenPeer[] {
  const words = text.split(',').flatMap((word) => (word === 'all' ? PEER_NAMES : [word]));
  const chosen = words.map((word) => choosePeer(word, folder));
  for (const { name } of chosen)
    if (chosen.filter((each) => each.name === name).length > 1)
      throw new BenchError(`--peers has ${name} twice.`);
  return chosen;
}

function choosePeer(word: string, folder: string): ChosenPeer {
  const [, name, adapter, options = ''] = /^([^=?]+)(?:=([^?]+))?(?:\?(.*))?$/.exec(word) ?? [];
  const known = KNOWN_PEERS.find((each) => each.name === name);
  if (!name || (known && adapter))
    throw new BenchError(`--peers has "${word}": a peer of one's own is NAME=ADAPTER, with a new name.`);
  const label = options ? `${name}?${options}` : name;
  if (adapter) {
    const adapterPath = isAbsolute(adapter) ? adapter : resolve(folder, adapter);
    return {
      name: label,
      adapterPath,
      options,
      isFloor: false,
      packageFile: null,
      isOnDemand: false,
    };
  }
  if (!known)
    throw new BenchError(
      `--peers has "${name}"; known are ${PEER_NAMES.join(', ')}, and NAME=ADAPTER for others.`,
    );
  const { package: own } = known;
  return {
    name: label,
    adapterPath: resolve(labFolder, known.adapter),
    options: [known.options, options].filter(Boolean).join('&'),
    isFloor: known.isFloor ?? false,
    packageFile: own ? resolve(packageFolders[own.at], 'node_modules', own.folder, 'package.json') : null,
    isOnDemand: own?.at === 'peers',
  };
}
