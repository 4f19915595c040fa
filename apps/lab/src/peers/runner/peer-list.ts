import { existsSync } from 'node:fs';
import { isAbsolute, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { BenchError } from './bench-error.ts';

/** A peer that the bench knows by name. */
export interface KnownPeer {
  readonly name: string;
  /** Path from apps/lab. */
  readonly adapter: string;
  /** For the adapter, as in an address. */
  readonly options?: string;
  /** Folder of the peer's package: below apps/lab/peers, installed on demand, or the root. */
  readonly package?: { readonly at: 'peers' | 'root'; readonly folder: string };
  /** A peer that is no package. */
  readonly source?: KnownSource;
  /** Draws nothing: shows the time of measuring itself. */
  readonly isFloor?: true;
}

/** A repository that users clone by themselves. */
interface KnownSource {
  readonly repository: string;
  /** That the adapter was written for. */
  readonly commit: string;
  /** The file that must be there, and how it comes there if cloning is not enough. */
  readonly file: string;
  readonly preparation?: string;
}

/** In the order in which they are measured. All are measured by default. */
const KNOWN_PEERS: readonly KnownPeer[] = [
  { name: 'floor-webgpu', adapter: 'src/peers/adapters/floor.ts', isFloor: true },
  { name: 'floor-webgl2', adapter: 'src/peers/adapters/floor.ts', options: 'api=webgl2', isFloor: true },
  { name: 'floor-three', adapter: 'src/peers/adapters/floor-three.ts', isFloor: true },
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
  {
    name: 'antimatter15',
    adapter: 'peers/antimatter15.js',
    source: {
      repository: 'https://github.com/antimatter15/splat',
      commit: 'ba182b51b7c2',
      file: 'main.js',
    },
  },
  {
    name: 'web-splat',
    adapter: 'peers/web-splat.js',
    source: {
      repository: 'https://github.com/KeKsBoTer/web-splat',
      commit: '959a3ecc2b64',
      preparation: 'compile it by apps/lab/peers/web-splat/build.sh',
      file: 'lab/web_splat_peer.js',
    },
  },
];

export const PEER_NAMES: readonly string[] = KNOWN_PEERS.map(({ name }) => name);

const labFolder = fileURLToPath(new URL('../../..', import.meta.url));
export const peersFolder = resolve(labFolder, 'peers');
/** Folder of clones, each in a folder of its peer's name. */
export const sourcesFolder = resolve(peersFolder, 'sources');
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
  /** Whether its package is installed on demand. */
  readonly isOnDemand: boolean;
  /** Its clone, if users have to make one. */
  readonly source: PeerSource | null;
}

/** A clone of a peer's repository. */
export interface PeerSource {
  readonly folder: string;
  /** Says how to complete the folder; null if it is complete. */
  readonly lack: string | null;
}

/**
 * Reads names of peers: `NAME` of {@link PEER_NAMES}, `NAME=ADAPTER` with a path from `folder` for
 * a peer of one's own, each with `?OPTIONS` for its adapter at the end, or `all`.
 *
 * @param sources folder of the clones of peers that are no packages.
 * @throws BenchError for names that are unknown or double, and for peers named whose clones are not
 * there.
 */
export function choosePeers(text: string, folder: string, sources = sourcesFolder): ChosenPeer[] {
  const words = text.split(',').flatMap((word) => (word === 'all' ? PEER_NAMES : [word]));
  const chosen = words.map((word) => choosePeer(word, folder, sources));
  for (const { name, source } of chosen) {
    if (chosen.filter((each) => each.name === name).length > 1)
      throw new BenchError(`--peers has ${name} twice.`);
    if (source?.lack && text.split(',').includes(name)) throw new BenchError(`--peers: ${source.lack}`);
  }
  return chosen;
}

function choosePeer(word: string, folder: string, sources: string): ChosenPeer {
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
      source: null,
    };
  }
  if (!known)
    throw new BenchError(
      `--peers has "${name}"; known are ${PEER_NAMES.join(', ')}, and NAME=ADAPTER for others.`,
    );
  return knownPeer(known, options, sources);
}

/** A peer that is known, with more `options` for its adapter. */
export function knownPeer(known: KnownPeer, options: string, sources = sourcesFolder): ChosenPeer {
  const { name, package: own } = known;
  return {
    name: options ? `${name}?${options}` : name,
    adapterPath: resolve(labFolder, known.adapter),
    options: [known.options, options].filter(Boolean).join('&'),
    isFloor: known.isFloor ?? false,
    packageFile: own ? resolve(packageFolders[own.at], 'node_modules', own.folder, 'package.json') : null,
    isOnDemand: own?.at === 'peers',
    source: known.source ? sourceOf(known.source, resolve(sources, name)) : null,
  };
}

function sourceOf({ repository, commit, file, preparation }: KnownSource, folder: string): PeerSource {
  if (existsSync(resolve(folder, file))) return { folder, lack: null };
  const steps = `clone ${repository} (its adapter knows commit ${commit}) there${preparation ? `, ${preparation}` : ''}`;
  const lack = `${folder} has no ${file}: ${steps}, or name the folder above by --sources.`;
  return { folder, lack };
}

/** The repository's setup of the peers' packages. */
export interface PeersInstallation {
  /** Whether they are there, in the versions of their lock. */
  readonly isInstalled: () => boolean;
  /** Returns whether it worked. */
  readonly install: () => boolean;
}

/**
 * Installs the packages of `peers` that are missing. Peers without a complete clone are left out.
 *
 * @returns the peers that can be measured.
 */
export function withPackages(
  peers: readonly ChosenPeer[],
  { isInstalled, install }: PeersInstallation,
  installs: boolean,
  say: (line: string) => void,
): ChosenPeer[] {
  for (const { name, source } of peers) if (source?.lack) say(`${name} is left out: ${source.lack}`);
  const there = peers.filter(({ source }) => !source?.lack);
  const onDemand = there.filter((peer) => peer.isOnDemand);
  if (onDemand.length === 0 || isInstalled() || (installs && install())) return there;
  const names = onDemand.map(({ name }) => name).join(', ');
  say(`Left out, because their packages are not installed: ${names}.`);
  return there.filter((peer) => !peer.isOnDemand);
}
