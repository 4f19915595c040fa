import type { LeafLevel, LeafPart, LeafScene, SceneLeaf } from '../../../data/bricks/leaf-scene.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { emptyBounds } from '../../../data/packing/center-bounds.ts';
import { chunkCountOf } from '../../../data/packing/chunks.ts';
import type { Bounds } from '../../../data/packing/packed-cloud.ts';
import { SceneWorkers } from '../../loading/scene-workers.ts';
import { KeptReads } from '../../sources/kept-reads.ts';
import type { ReadOptions, SplatSource } from '../../sources/splat-source.ts';
import type { ChunkNodes, PackedChunk, RadFacts } from './pack-nodes.ts';
import { openRadSource, type RadSource } from './rad-source.ts';
import { wrongTree } from './tree-check.ts';
import { type ChunkRange, type DividedPart, ROOT_PART, TreeDivider, type TreePart } from './tree-parts.ts';

/** Most leaves per chunk of a large scene; each leaf may end with a partly filled chunk. */
const LEAVES_OF_CHUNK = 32;
/**
 * Most bytes of fetched chunks that are kept: each with its compressed data and its `ChunkNodes`. A view
 * that turns back then needs no second fetch.
 */
const KEPT_BYTES = 256 << 20;
/** Least error of a level above the finest, so that splats of size 0 are refined, too. */
const LEAST_ERROR = 1e-9;

/** A fetched chunk; workers decode and pack its nodes from the compressed bytes. */
interface FetchedChunk {
  readonly packed: PackedChunk;
  readonly nodes: ChunkNodes;
  readonly bytes: number;
}

let lastKey = 0;

/** A leaf, and the subtree whose division is its finest level. */
interface OwnLeaf {
  readonly number: number;
  readonly leaf: SceneLeaf & { readonly levels: LeafLevel[] };
  readonly part: TreePart;
  /** Parent leaf; undefined for the root. */
  readonly above: OwnLeaf | undefined;
  /** Child leaves, in the order of division; null before the subtree was decoded. */
  below: readonly OwnLeaf[] | null;
}

/**
 * Opens a `.rad` with a tree for streaming; each chunk is read on request. The first chunk is read
 * now and yields the first leaves.
 *
 * A leaf begins with nodes whose children lie in one other chunk. These nodes are its coarsest
 * level; their descendants in that chunk are its finest. Descendants with children in further
 * chunks begin child leaves.
 *
 * Rejects with SplatSourceError if the file cannot be fetched, and SplatFileError if the scene is
 * damaged or lacks a file. Rejects with InvalidArgumentError if the value is no source, and the
 * signal's reason.
 *
 * @returns null for streams, other files, scenes without a tree or with a single chunk, and large
 *   files on a server without range requests.
 */
export async function openRad(
  source: SplatSource,
  options: Omit<ReadOptions, 'onProgress'> = {},
): Promise<LeafScene | null> {
  const opened = await openRadSource(source, options);
  if (!opened?.header.isTree || opened.header.chunks.length < 2) return null;
  const scene = new RadScene(opened, options);
  try {
    await scene.readRoot(options.signal);
    return scene;
  } catch (error) {
    scene.end();
    throw error;
  }
}

class RadScene implements LeafScene {
  readonly name: string;
  readonly splatCount: number;
  readonly shDegree: LeafScene['shDegree'];
  origin: Vec3 = [0, 0, 0];
  readonly leaves: SceneLeaf[] = [];
  readonly mostChunks: number;
  fetchedBytes = 0;
  readonly #source: RadSource;
  readonly #maxBytes: number | undefined;
  readonly #tree: TreeDivider;
  readonly #own = new Map<SceneLeaf, OwnLeaf>();
  /** Chunk range of each file index; `#fileNumbers` maps ranges to indices. */
  readonly #files: ChunkRange[] = [];
  readonly #fileNumbers = new Map<string, number>();
  readonly #chunks = new KeptReads<FetchedChunk>(KEPT_BYTES, ({ bytes }) => bytes);
  readonly #workers: SceneWorkers;
  /** The first chunk; null before it is read. */
  #first: PackedChunk | null = null;
  /** Number of leaves whose finest level was never decoded. */
  #unknownCount = 1;

  constructor(source: RadSource, { maxBytes }: Pick<ReadOptions, 'maxBytes'>) {
    const { count, shDegree, chunks } = source.header;
    this.name = source.name;
    this.splatCount = count;
    this.shDegree = shDegree;
    this.mostChunks = chunkCountOf(count) + LEAVES_OF_CHUNK * chunks.length;
    this.#source = source;
    this.#workers = new SceneWorkers(source.name);
    this.#maxBytes = maxBytes;
    this.#tree = new TreeDivider(count, chunks[0].count, source.name);
  }

  /** Reads the first chunk and creates its leaves. */
  async readRoot(signal: AbortSignal | undefined): Promise<void> {
    const chunk = await this.#chunk(0, signal);
    this.origin = chunk.nodes.origin;
    const level = this.#levelOf(ROOT_PART.chunks, 1, 1, 0);
    const root: OwnLeaf = {
      number: 0,
      leaf: { bounds: null, levels: [level], rank: 0 },
      part: ROOT_PART,
      above: undefined,
      below: null,
    };
    this.leaves.push(root.leaf);
    this.#own.set(root.leaf, root);
    this.#divide(root, [chunk.nodes]);
  }

  read: LeafScene['read'] = async (file, signal, onBytes) => {
    const { first, last } = this.#files[file];
    const numbers = Array.from({ length: last - first + 1 }, (_, i) => first + i);
    const fetched = await Promise.all(numbers.map((number) => this.#chunk(number, signal, onBytes)));
    const chunks = fetched.map(({ nodes }) => nodes);
    const packed = fetched.map((chunk) => chunk.packed);
    const divided = new Map<OwnLeaf, DividedPart>();
    const divide = (own: OwnLeaf) => {
      const found = divided.get(own) ?? this.#divide(own, chunks);
      divided.set(own, found);
      return found;
    };
    const nodesOf = ({ leaf, level }: LeafPart) => {
      const own = this.#own.get(leaf)!;
      const { above } = own;
      const isCoarsest = above && level === leaf.levels.at(-1);
      return isCoarsest ? divide(above).inner[above.below!.indexOf(own)].nodes : divide(own).leaves;
    };
    return {
      pack: async (parts, end) => {
        const input = { chunks: packed, facts: this.#factsWith(packed[0]), lists: parts.map(nodesOf) };
        return this.#workers.call('packRadNodes', input, { key: packed[0].key, signal: end });
      },
    };
  };

  get keptBytes(): number {
    return this.#chunks.bytes;
  }

  readonly end = () => this.#workers.end();

  /** Facts for decoding `chunk`. If no chunk has been read yet, `chunk` must be the first one. */
  #factsWith(chunk: PackedChunk): RadFacts {
    const { shDegree, paletteSize } = this.#source.header;
    const origin = this.#first && this.origin;
    return { shDegree, paletteSize, first: this.#first ?? chunk, origin, maxBytes: this.#maxBytes };
  }

  #chunk(
    number: number,
    signal: AbortSignal | undefined,
    onBytes?: (bytes: number) => void,
  ): Promise<FetchedChunk> {
    return this.#chunks.read(number, (ending) => this.#load(number, ending, onBytes), signal);
  }

  async #load(number: number, signal: AbortSignal, onBytes?: (bytes: number) => void): Promise<FetchedChunk> {
    const { name, header } = this.#source;
    const place = header.chunks[number];
    const bytes = await this.#source.read(number, signal, (count) => {
      this.fetchedBytes += count;
      onBytes?.(count);
    });
    const file = `${name}, ${place.path ?? `chunk ${number}`}`;
    const chunk: PackedChunk = { key: ++lastKey, bytes: new Blob([bytes]), place, file };
    const input = { chunk, facts: this.#factsWith(chunk) };
    const nodes = await this.#workers.call('readRadChunk', input, { key: chunk.key, signal });
    this.#first ??= chunk;
    return { packed: chunk, nodes, bytes: bytes.length + bytesOf(nodes) };
  }

  /**
   * Divides a leaf's subtree into its finest level and child leaves. The first call creates the
   * child leaves.
   */
  #divide(own: OwnLeaf, chunks: readonly ChunkNodes[]): DividedPart {
    const divided = this.#tree.divide(own.part, chunks, own.below === null);
    if (own.below) return divided;
    const { leaf, part } = own;
    // The root is always drawn, so its children count as leaves without a parent.
    const isRoot = own.above === undefined;
    let count = divided.leaves.length;
    let chunkCount = chunkCountOf(count);
    own.below = divided.inner.map(({ nodes, below }, i) => {
      const { bounds, error, splatCount } = factsOf(nodes, chunks);
      const childCount = below.counts.reduce((sum, each) => sum + each, 0);
      const finest = this.#levelOf(below.chunks, childCount, chunkCountOf(childCount), 0);
      const coarsest = this.#levelOf(part.chunks, splatCount, chunkCountOf(splatCount), error);
      count += isRoot ? 0 : coarsest.count;
      chunkCount += isRoot ? 0 : coarsest.chunkCount;
      const found: OwnLeaf = {
        number: this.leaves.length + i,
        leaf: {
          ...{ bounds, levels: [finest, coarsest], rank: below.starts[0] },
          ...(!isRoot && { above: own.number }),
        },
        part: below,
        above: own,
        below: null,
      };
      this.#own.set(found.leaf, found);
      return found;
    });
    leaf.levels[0] = { ...leaf.levels[0], count, chunkCount };
    for (const found of own.below) this.leaves.push(found.leaf);
    this.#unknownCount += own.below.length - 1;
    if (this.#unknownCount === 0 && this.#tree.leftCount > 0)
      throw wrongTree(this.name, `${this.#tree.leftCount} nodes have no parent`);
    return divided;
  }

  #levelOf(chunks: ChunkRange, count: number, chunkCount: number, error: number): LeafLevel {
    const key = `${chunks.first} ${chunks.last}`;
    const file = this.#fileNumbers.get(key) ?? this.#files.push(chunks) - 1;
    this.#fileNumbers.set(key, file);
    return { file, count, chunkCount, error };
  }
}

/** Bounding box of nodes, their error against their children, and their number of splats. */
function factsOf(
  nodes: Uint32Array,
  chunks: readonly ChunkNodes[],
): { bounds: Bounds; error: number; splatCount: number } {
  const { min, max } = emptyBounds();
  let areas = 0;
  let weighted = 0;
  let splatCount = 0;
  for (const node of nodes) {
    const { base, centers, scales, copies } = chunks[Math.floor((node - chunks[0].base) / chunks[0].count)];
    const i = node - base;
    const center = centers.subarray(3 * i, 3 * i + 3);
    const scale = scales[i];
    splatCount += copies[i];
    if (!center.every(Number.isFinite) || !Number.isFinite(scale)) continue;
    areas += scale ** 2;
    weighted += scale ** 4;
    for (let axis = 0; axis < 3; axis++) {
      min[axis] = Math.min(min[axis], center[axis] - scale);
      max[axis] = Math.max(max[axis], center[axis] + scale);
    }
  }
  const bounds: Bounds = areas > 0 ? { min, max } : { min: [0, 0, 0], max: [0, 0, 0] };
  const error = areas > 0 ? Math.max(LEAST_ERROR, Math.sqrt(weighted / areas)) : LEAST_ERROR;
  return { bounds, error, splatCount };
}

function bytesOf({ childCounts, childStarts, centers, scales, copies }: ChunkNodes): number {
  const arrays = [childCounts, childStarts, centers, scales, copies];
  return arrays.reduce((sum, { byteLength }) => sum + byteLength, 0);
}
