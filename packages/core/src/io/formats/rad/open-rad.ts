import {
  type LeafLevel,
  type LeafScene,
  NO_ROW,
  type SceneLeaf,
  type SplatCells,
} from '../../../data/bricks/leaf-scene.ts';
import { SplatFileError } from '../../../data/errors.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { emptyBounds } from '../../../data/packing/center-bounds.ts';
import { chunkCountOf } from '../../../data/packing/chunks.ts';
import { mortonOrder } from '../../../data/packing/morton-order.ts';
import { originOfSamples } from '../../../data/packing/origin.ts';
import type { Bounds } from '../../../data/packing/packed-cloud.ts';
import { logitOf } from '../../../data/splats/color-values.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { coefficientsPerSplat } from '../../../data/splats/splat-set.ts';
import { SceneWorkers } from '../../loading/scene-workers.ts';
import { KeptReads } from '../../sources/kept-reads.ts';
import { unpackedLimit } from '../../sources/read-limits.ts';
import type { ReadOptions, SplatSource } from '../../sources/splat-source.ts';
import { packPieces } from '../pack-pieces.ts';
import { type HarmonicsColumns, NodeRows, readPalette } from './node-rows.ts';
import { RadChunk } from './rad-chunk.ts';
import { openRadSource, type RadSource } from './rad-source.ts';
import { wrongTree } from './tree-check.ts';
import {
  type ChunkRange,
  type DividedPart,
  ROOT_PART,
  TreeDivider,
  type TreeNodes,
  type TreePart,
} from './tree-parts.ts';

/** Most leaves per chunk of a large scene; each leaf may end with a partly filled chunk. */
const LEAVES_OF_CHUNK = 32;
/** Cache size for decoded chunks: eight chunks of degree 3. */
const KEPT_BYTES = 128 << 20;
/** Least error of a level above the finest, so that splats of size 0 are refined, too. */
const LEAST_ERROR = 1e-9;

/** A decoded chunk. */
interface NodeChunk extends TreeNodes {
  readonly rows: NodeRows;
  readonly bytes: number;
}

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
  readonly #chunks = new KeptReads<NodeChunk>(KEPT_BYTES, ({ bytes }) => bytes);
  readonly #workers: SceneWorkers;
  #palette: HarmonicsColumns | undefined;
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
    this.#divide(root, [chunk]);
  }

  read: LeafScene['read'] = async (file, signal, onBytes) => {
    const { first, last } = this.#files[file];
    const numbers = Array.from({ length: last - first + 1 }, (_, i) => first + i);
    const chunks = await Promise.all(numbers.map((number) => this.#chunk(number, signal, onBytes)));
    const divided = new Map<OwnLeaf, DividedPart>();
    const divide = (own: OwnLeaf) => {
      const found = divided.get(own) ?? this.#divide(own, chunks);
      divided.set(own, found);
      return found;
    };
    return {
      pieces: async (leaf, level, end) => {
        const own = this.#own.get(leaf)!;
        const { above } = own;
        const nodes =
          above && level === leaf.levels.at(-1)
            ? divide(above).inner[above.below!.indexOf(own)].nodes
            : divide(own).leaves;
        return this.#cells(nodes, chunks, end);
      },
    };
  };

  readonly end = () => this.#workers.end();

  #chunk(
    number: number,
    signal: AbortSignal | undefined,
    onBytes?: (bytes: number) => void,
  ): Promise<NodeChunk> {
    return this.#chunks.read(number, (ending) => this.#load(number, ending, onBytes), signal);
  }

  async #load(number: number, signal: AbortSignal, onBytes?: (bytes: number) => void): Promise<NodeChunk> {
    const { name, header } = this.#source;
    const place = header.chunks[number];
    const file = `${name}, ${place.path ?? `chunk ${number}`}`;
    const packed = await this.#source.read(number, signal, (bytes) => {
      this.fetchedBytes += bytes;
      onBytes?.(bytes);
    });
    const limit = unpackedLimit({ maxBytes: this.#maxBytes }, { totalBytes: packed.length });
    let unpackedBytes = 0;
    const chunk = new RadChunk(packed, place, file, (byteCount) => {
      signal.throwIfAborted();
      unpackedBytes += byteCount;
      if (unpackedBytes <= limit) return;
      const message = `it unpacks to ${unpackedBytes} bytes or more, and ${limit} are the limit. Pass a larger maxBytes if that is right.`;
      throw new SplatFileError('too-large', file, message);
    });
    const { base, count } = place;
    const childCounts = await chunk.column('child_count', count);
    const childStarts = await chunk.column('child_start', count);
    if (number === 0) this.#palette = await readPalette(chunk, header);
    const rows = await NodeRows.read(chunk, count, header.shDegree, this.#palette, file);
    // The uppermost nodes approximate the whole scene.
    if (number === 0) this.origin = originOfSamples(rows.centers);
    rows.moveTo(this.origin);
    const bytes = rows.bytes + childCounts.byteLength + childStarts.byteLength;
    return { base, count, childCounts, childStarts, rows, bytes };
  }

  /**
   * Divides a leaf's subtree into its finest level and child leaves. The first call creates the
   * child leaves.
   */
  #divide(own: OwnLeaf, chunks: readonly NodeChunk[]): DividedPart {
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

  /** Packs nodes in Morton order; an inner node becomes a stack of several splats. */
  async #cells(
    nodes: Uint32Array,
    chunks: readonly NodeChunk[],
    signal: AbortSignal | undefined,
  ): Promise<SplatCells[]> {
    const finite = nodes.filter((node) => {
      const [{ rows }, i] = placeIn(chunks, node);
      return [0, 1, 2].every((axis) => Number.isFinite(rows.center(i, axis)));
    });
    const centers = new Float32Array(3 * finite.length);
    for (const [at, node] of finite.entries()) {
      const [{ rows }, i] = placeIn(chunks, node);
      for (let axis = 0; axis < 3; axis++) centers[3 * at + axis] = rows.center(i, axis);
    }
    const splats: { readonly node: number; readonly copy: number }[] = [];
    for (const at of mortonOrder(centers, finite.length)) {
      const node = finite[at];
      const copies = stackIn(chunks, node).opacities.length;
      for (let copy = 0; copy < copies; copy++) splats.push({ node, copy });
    }
    const row = new Float64Array(ROW_SLOT.harmonics + coefficientsPerSplat(this.shDegree));
    const fill = (at: number) => {
      const { node, copy } = splats[at];
      const [{ rows, childCounts }, i] = placeIn(chunks, node);
      rows.fill(row, i);
      if (childCounts[i] === 0) return node;
      const { opacities, growth } = stackIn(chunks, node);
      row[ROW_SLOT.opacity] = logitOf(opacities[copy]);
      for (let axis = 0; axis < 3; axis++) row[ROW_SLOT.logScale + axis] += growth;
      return NO_ROW;
    };
    return packPieces(this.#workers, splats.length, this.shDegree, row, fill, signal);
  }

  #levelOf(chunks: ChunkRange, count: number, chunkCount: number, error: number): LeafLevel {
    const key = `${chunks.first} ${chunks.last}`;
    const file = this.#fileNumbers.get(key) ?? this.#files.push(chunks) - 1;
    this.#fileNumbers.set(key, file);
    return { file, count, chunkCount, error };
  }
}

/** The chunk of a node, and the node's index in it. */
function placeIn(chunks: readonly NodeChunk[], node: number): [chunk: NodeChunk, i: number] {
  const chunk = chunks[Math.floor((node - chunks[0].base) / chunks[0].count)];
  return [chunk, node - chunk.base];
}

/** Splats that draw a node: one for a node without children. */
function stackIn(chunks: readonly NodeChunk[], node: number): Stack {
  const [{ rows, childCounts }, i] = placeIn(chunks, node);
  return stackOf(childCounts[i] > 0 ? rows.alpha(i) : Math.min(1, rows.alpha(i)));
}

/** Bounding box of nodes, their error against their children, and their number of splats. */
function factsOf(
  nodes: Uint32Array,
  chunks: readonly NodeChunk[],
): { bounds: Bounds; error: number; splatCount: number } {
  const { min, max } = emptyBounds();
  let areas = 0;
  let weighted = 0;
  let splatCount = 0;
  for (const node of nodes) {
    const [{ rows }, i] = placeIn(chunks, node);
    splatCount += stackIn(chunks, node).opacities.length;
    const scale = rows.largestScale(i);
    if (![0, 1, 2].every((axis) => Number.isFinite(rows.center(i, axis))) || !Number.isFinite(scale))
      continue;
    areas += scale ** 2;
    weighted += scale ** 4;
    for (let axis = 0; axis < 3; axis++) {
      min[axis] = Math.min(min[axis], rows.center(i, axis) - scale);
      max[axis] = Math.max(max[axis], rows.center(i, axis) + scale);
    }
  }
  const bounds: Bounds = areas > 0 ? { min, max } : { min: [0, 0, 0], max: [0, 0, 0] };
  const error = areas > 0 ? Math.max(LEAST_ERROR, Math.sqrt(weighted / areas)) : LEAST_ERROR;
  return { bounds, error, splatCount };
}

/** Most splats per node. */
const MOST_COPIES = 4;

/** Coincident splats that draw an inner node. */
interface Stack {
  /** Opacities, from 0 to 1. */
  readonly opacities: readonly number[];
  /** Log of a factor on the scales. */
  readonly growth: number;
}

/**
 * Splats for a node with a stored opacity above 1, up to 2. Spark draws the opacity 1 − (1 − g)ⁿ,
 * where g is the node's Gaussian and n = exp(((4 · opacity − 3)² − 1) / e). This equals n stacked
 * splats of opacity 1; here, the last copy has the fractional part of n as opacity. Above four
 * copies, four larger ones cover the same area: n copies cover harmonic number of n times the area
 * of one.
 */
export function stackOf(opacity: number): Stack {
  if (!(opacity > 1)) return { opacities: [opacity], growth: 0 };
  const stacked = Math.exp(((4 * Math.min(opacity, 2) - 3) ** 2 - 1) / Math.E);
  const copies = Math.min(stacked, MOST_COPIES);
  const opacities = Array.from({ length: Math.ceil(copies) }, (_, i) => Math.min(1, copies - i));
  return { opacities, growth: Math.log(harmonicNumber(stacked) / harmonicNumber(copies)) / 2 };
}

/** ∫₀¹ (1 − tⁿ) / (1 − t) dt for n ≥ 1, to four digits. */
function harmonicNumber(n: number): number {
  return Math.log(n) + 0.5772156649 + 1 / (2 * n) - 1 / (12 * n * n) + 1 / (120 * n ** 4);
}
