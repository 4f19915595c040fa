import { open } from 'node:fs/promises';
import { BenchError } from '../runner/bench-error.ts';
import type { CommonOptions } from '../runner/options.ts';
import { type ChosenPeer, type KnownPeer, knownPeer } from '../runner/peer-list.ts';

/** A file of the scene. */
export type StreamFormat = 'bricks' | 'sog' | 'rad';
/** Paths of a scene's files. */
export type StreamFiles = Readonly<Partial<Record<StreamFormat, string>>>;

/** Limits of drawn and held splats, for all peers; null for the finest picture, without limits. */
export type Budget = { readonly maxSplats: number; readonly poolBytes: number } | null;

/** Options of an adapter, by the names of its renderer's settings. */
type Settings = Readonly<Record<string, number>>;

interface StreamPeer extends KnownPeer {
  readonly format: StreamFormat;
  /** The adapter's options for a budget. */
  readonly settings: (budget: Budget, file: string) => Settings | Promise<Settings>;
}

const ownSettings = (budget: Budget): Settings =>
  budget ? { maxSplats: budget.maxSplats, budgetBytes: budget.poolBytes } : {};
const OWN = { adapter: 'src/peers/adapters/websplatter-stream.ts', settings: ownSettings } as const;

/** In the order in which they are measured. */
const STREAM_PEERS: readonly StreamPeer[] = [
  { name: 'websplatter', format: 'bricks', ...OWN },
  { name: 'websplatter-sog', format: 'sog', ...OWN },
  {
    name: 'websplatter-react-sog',
    format: 'sog',
    adapter: 'src/peers/adapters/websplatter-react-stream.tsx',
    settings: ownSettings,
  },
  { name: 'websplatter-rad', format: 'rad', ...OWN },
  {
    name: 'playcanvas',
    format: 'sog',
    adapter: 'peers/playcanvas-stream.js',
    package: { at: 'peers', folder: 'playcanvas' },
    // It has no limit of memory: it evicts nodes that it has not drawn for a while. 0 is no budget.
    settings: (budget) => ({ splatBudget: budget?.maxSplats ?? 0 }),
  },
  {
    name: 'spark',
    format: 'rad',
    adapter: 'peers/spark-stream.js',
    package: { at: 'peers', folder: '@sparkjsdev/spark' },
    settings: sparkSettings,
  },
];

export const STREAM_PEER_NAMES: readonly string[] = STREAM_PEERS.map(({ name }) => name);

/** The peer of a name on the command line, options included. */
export function streamPeer(label: string): StreamPeer {
  const [name] = label.split('?');
  const peer = STREAM_PEERS.find((each) => each.name === name);
  if (!peer) throw new BenchError(`--peers has "${label}"; known are ${STREAM_PEER_NAMES.join(', ')}.`);
  return peer;
}

/**
 * Reads names of peers; `all` chooses every peer whose file is given, and in a pack every peer.
 *
 * @throws BenchError for names that are unknown, and for peers named without their files.
 */
export function chooseStreamPeers({
  peers,
  files,
  packFolder,
}: CommonOptions & { readonly files: StreamFiles }): ChosenPeer[] {
  const isThere = ({ format }: StreamPeer) => packFolder !== null || files[format] !== undefined;
  if (peers === 'all') return STREAM_PEERS.filter(isThere).map((peer) => knownPeer(peer, ''));
  return peers.split(',').map((label) => {
    const peer = streamPeer(label);
    if (!isThere(peer)) throw new BenchError(`--peers has ${label}: give --${peer.format}.`);
    return knownPeer(peer, label.slice(peer.name.length + 1));
  });
}

/**
 * The peers of a pack whose files are given: a pack may hold more than one run measures.
 *
 * @throws BenchError if none is left, and for a peer that `options.peers` names without its file.
 */
export function withFiles<Peer extends { readonly name: string }>(
  packed: readonly Peer[],
  { peers, files }: Pick<CommonOptions, 'peers'> & { readonly files: StreamFiles },
): Peer[] {
  const lacking = packed.filter(({ name }) => files[streamPeer(name).format] === undefined);
  if (lacking.length > 0 && (peers !== 'all' || lacking.length === packed.length)) {
    const { name } = lacking[0];
    throw new BenchError(`The file of ${name} is missing: give --${streamPeer(name).format}.`);
  }
  return packed.filter((peer) => !lacking.includes(peer));
}

/** Splats of a page of Spark. */
const PAGE_SPLATS = 65_536;
/** Bytes of a splat in Spark's pages, by the degree of harmonics: four words, then each band's. */
const SPARK_BYTES = [16, 24, 40, 56];

async function sparkSettings(budget: Budget, file: string): Promise<Settings> {
  const { count, maxSh } = await radFacts(file);
  const pagesOf = (splats: number, round: (pages: number) => number) =>
    PAGE_SPLATS * round(splats / PAGE_SPLATS);
  const whole = pagesOf(count, Math.ceil);
  // All nodes in memory, and no node too small: the limit is a pixel by default.
  if (!budget) return { lodSplatCount: count, maxPagedSplats: whole, lodRenderScale: 0 };
  const held = Math.max(PAGE_SPLATS, pagesOf(budget.poolBytes / SPARK_BYTES[maxSh], Math.floor));
  return { lodSplatCount: budget.maxSplats, maxPagedSplats: Math.min(whole, held) };
}

/** Splats of all levels, and the degree of their harmonics: from the JSON behind 8 bytes. */
async function radFacts(file: string): Promise<{ readonly count: number; readonly maxSh: number }> {
  const handle = await open(file);
  try {
    const { buffer: start } = await handle.read(Buffer.alloc(8), 0, 8, 0);
    if (start.toString('latin1', 0, 4) !== 'RAD0') throw new BenchError(`${file} is no .rad.`);
    const bytes = start.readUInt32LE(4);
    const { buffer: json } = await handle.read(Buffer.alloc(bytes), 0, bytes, 8);
    return JSON.parse(json.toString('utf8').replace(/\0+$/, ''));
  } finally {
    await handle.close();
  }
}
