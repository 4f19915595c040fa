import type { LeafLevel, LeafPart, LeafScene, SceneLeaf } from '../../../data/bricks/leaf-scene.ts';
import { SplatFileError } from '../../../data/errors.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { chunkCountOf } from '../../../data/packing/chunks.ts';
import { SceneWorkers } from '../../loading/scene-workers.ts';
import { KeptReads } from '../../sources/kept-reads.ts';
import type { KnownSource } from '../../sources/known-source.ts';
import type { ReadOptions } from '../../sources/splat-source.ts';
import type { PackedChunk } from './decoded-chunk.ts';
import type { KeyedPart, PartFacts, RadChunks } from './divide-part.ts';
import type { NodesOfPart } from './pack-nodes.ts';
import { openRadSource, type RadSource } from './rad-source.ts';
import { wrongTree } from './tree-check.ts';
import { type ChunkRange, ROOT_PART, TakenNodes, type TreeShape } from './tree-parts.ts';

/** Most leaves per chunk of a large scene; each leaf may end with a partly filled chunk. */
const LEAVES_OF_CHUNK = 32;
/** Most bytes of fetched chunks that are kept. A view that turns back then needs no second fetch. */
const KEPT_BYTES = 256 << 20;

let lastKey = 0;

/** A leaf, and the subtree whose division is its finest level. */
interface OwnLeaf {
  readonly number: number;
  readonly leaf: SceneLeaf & { readonly levels: LeafLevel[] };
  readonly part: KeyedPart;
  /** Parent leaf; undefined for the root. */
  readonly above: OwnLeaf | undefined;
  /** Child leaves, in the order of division; null before the subtree was divided. */
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
  source: KnownSource,
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
  readonly #tree: TreeShape;
  readonly #taken: TakenNodes;
  readonly #own = new Map<SceneLeaf, OwnLeaf>();
  /** Chunk range of each file index; `#fileNumbers` maps ranges to indices. */
  readonly #files: ChunkRange[] = [];
  readonly #fileNumbers = new Map<string, number>();
  /** Workers decode, divide and pack chunks from the compressed bytes. */
  readonly #chunks = new KeptReads<PackedChunk>(KEPT_BYTES, ({ bytes }) => bytes.size);
  readonly #workers: SceneWorkers;
  /** The first chunk; null before it is read. */
  #first: PackedChunk | null = null;
  /** Number of leaves whose subtree was never divided. */
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
    this.#tree = { nodeCount: count, chunkSize: chunks[0].count, file: source.name };
    this.#taken = new TakenNodes(this.#tree);
  }

  /** Reads the first chunk and creates its leaves. */
  async readRoot(signal: AbortSignal | undefined): Promise<void> {
    const chunks = this.#with([await this.#chunk(0, signal)]);
    const part = { ...ROOT_PART, key: ++lastKey };
    const { key } = chunks.chunks[0];
    const facts = await this.#workers.call('divideRadPart', { chunks, part }, { key, signal });
    this.origin = facts.origin;
    const level = this.#levelOf(ROOT_PART.chunks, 1, 1, 0);
    const root: OwnLeaf = {
      number: 0,
      leaf: { bounds: null, levels: [level], rank: 0 },
      part,
      above: undefined,
      below: null,
    };
    this.leaves.push(root.leaf);
    this.#own.set(root.leaf, root);
    this.#addBelow(root, facts);
  }

  read: LeafScene['read'] = async (file, signal, onBytes) => {
    const { first, last } = this.#files[file];
    const numbers = Array.from({ length: last - first + 1 }, (_, i) => first + i);
    const fetched = await Promise.all(numbers.map((number) => this.#chunk(number, signal, onBytes)));
    const chunks = this.#with(fetched);
    return {
      pack: async (parts, end) => {
        try {
          return await this.#pack(chunks, parts, end);
        } catch (error) {
          // The server may have sent something else: it is asked again.
          if (error instanceof SplatFileError) for (const number of numbers) this.#chunks.forget(number);
          throw error;
        }
      },
    };
  };

  async #pack(chunks: RadChunks, parts: readonly LeafPart[], signal: AbortSignal | undefined) {
    const { key } = chunks.chunks[0];
    const lists: NodesOfPart[] = [];
    for (const { leaf, level } of parts) {
      const own = this.#own.get(leaf)!;
      const { above, part } = own;
      if (above && level === leaf.levels.at(-1)) {
        lists.push({ part: above.part, inner: above.below!.indexOf(own) });
        continue;
      }
      if (!own.below)
        this.#addBelow(own, await this.#workers.call('divideRadPart', { chunks, part }, { key, signal }));
      lists.push({ part, inner: null });
    }
    return this.#workers.call('packRadNodes', { chunks, lists }, { key, signal });
  }

  get keptBytes(): number {
    return this.#chunks.bytes;
  }

  readonly end = () => this.#workers.end();

  /** Chunks with facts about the scene. If no chunk was read before, the first of them is the scene's. */
  #with(chunks: readonly PackedChunk[]): RadChunks {
    const { shDegree, paletteSize } = this.#source.header;
    const facts = {
      ...{
        shDegree,
        paletteSize,
        origin: this.leaves.length > 0 ? this.origin : null,
        maxBytes: this.#maxBytes,
      },
      first: this.#first ?? chunks[0],
    };
    return { chunks, facts, tree: this.#tree };
  }

  #chunk(
    number: number,
    signal: AbortSignal | undefined,
    onBytes?: (bytes: number) => void,
  ): Promise<PackedChunk> {
    return this.#chunks.read(number, (ending) => this.#load(number, ending, onBytes), signal);
  }

  async #load(number: number, signal: AbortSignal, onBytes?: (bytes: number) => void): Promise<PackedChunk> {
    const { name, header } = this.#source;
    const place = header.chunks[number];
    const bytes = await this.#source.read(number, signal, (count) => {
      this.fetchedBytes += count;
      onBytes?.(count);
    });
    const file = `${name}, ${place.path ?? `chunk ${number}`}`;
    const chunk: PackedChunk = { key: ++lastKey, bytes: new Blob([bytes]), place, file };
    this.#first ??= chunk;
    return chunk;
  }

  /** Adds the child leaves of a leaf whose subtree was divided. */
  #addBelow(own: OwnLeaf, { leafCount, inner, contained }: PartFacts): void {
    // Another call may have divided it meanwhile.
    if (own.below) return;
    const { leaf, part } = own;
    this.#taken.take(part.chunks.first * this.#tree.chunkSize, contained);
    // The root is always drawn, so its children count as leaves without a parent.
    const isRoot = own.above === undefined;
    let count = leafCount;
    let chunkCount = chunkCountOf(count);
    own.below = inner.map(({ below, bounds, error, splatCount }, i) => {
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
        part: { ...below, key: ++lastKey },
        above: own,
        below: null,
      };
      this.#own.set(found.leaf, found);
      return found;
    });
    leaf.levels[0] = { ...leaf.levels[0], count, chunkCount };
    for (const found of own.below) this.leaves.push(found.leaf);
    this.#unknownCount += own.below.length - 1;
    if (this.#unknownCount === 0 && this.#taken.leftCount > 0)
      throw wrongTree(this.name, `${this.#taken.leftCount} nodes have no parent`);
  }

  #levelOf(chunks: ChunkRange, count: number, chunkCount: number, error: number): LeafLevel {
    const key = `${chunks.first} ${chunks.last}`;
    const file = this.#fileNumbers.get(key) ?? this.#files.push(chunks) - 1;
    this.#fileNumbers.set(key, file);
    return { file, count, chunkCount, error };
  }
}
