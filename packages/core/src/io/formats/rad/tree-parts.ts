import type { SplatFileError } from '../../../data/errors.ts';
import { checkFamily, wrongTree } from './tree-check.ts';

/** Nodes of a chunk, reduced to the tree structure. */
interface TreeNodes {
  /** Index of the first node. */
  readonly base: number;
  readonly count: number;
  readonly childCounts: ArrayLike<number>;
  readonly childStarts: ArrayLike<number>;
}

/** Consecutive chunks that contain whole families. */
export interface ChunkRange {
  readonly first: number;
  readonly last: number;
}

/** A subtree within its chunks: nodes whose parents lie in earlier chunks, and their descendants. */
export interface TreePart {
  readonly chunks: ChunkRange;
  /** First node of each family, ascending, and number of nodes per family. */
  readonly starts: Uint32Array;
  readonly counts: Uint32Array;
}

/** The nodes of a part. */
export interface DividedPart {
  /** Nodes without children, ascending. */
  readonly leaves: Uint32Array;
  /** Nodes whose children lie in other chunks, grouped by the child parts; nearest chunks first. */
  readonly inner: readonly { readonly nodes: Uint32Array; readonly below: TreePart }[];
  /** One bit per node of the part's chunks, in order: whether the part contains the node. */
  readonly contained: Uint32Array<ArrayBuffer>;
}

/** The tree that a part belongs to. Can be posted. */
export interface TreeShape {
  readonly nodeCount: number;
  /** Nodes per chunk; the last one may have fewer. */
  readonly chunkSize: number;
  /** Name in messages. */
  readonly file: string;
}

/** The part that contains the root, in the first chunk. */
export const ROOT_PART: TreePart = {
  chunks: { first: 0, last: 0 },
  starts: Uint32Array.of(0),
  counts: Uint32Array.of(1),
};

/**
 * Divides a part.
 *
 * @param chunks the chunks of the part.
 * @throws SplatFileError 'damaged' for misplaced children, or for a child with several parents within
 *   the part.
 */
export function dividePart(
  { starts, counts }: TreePart,
  chunks: readonly TreeNodes[],
  { nodeCount, chunkSize, file }: TreeShape,
): DividedPart {
  const [{ base }] = chunks;
  const { base: lastBase, count: lastCount } = chunks.at(-1)!;
  const end = lastBase + lastCount;
  const contained = new Uint32Array(Math.ceil((end - base) / 32));
  const leaves: number[] = [];
  const outside: number[] = [];
  const families: [number, number][] = [...starts].map((start, i) => [start, counts[i]]);
  const nodeOf = (node: number) => {
    const { base: first, childCounts, childStarts } = chunks[Math.floor((node - base) / chunkSize)];
    return { childCount: childCounts[node - first], childStart: childStarts[node - first] };
  };
  for (let family = families.pop(); family; family = families.pop()) {
    for (let node = family[0]; node < family[0] + family[1]; node++) {
      const bit = 1 << ((node - base) & 31);
      if (contained[(node - base) >> 5] & bit) throw severalParents(node, file);
      contained[(node - base) >> 5] |= bit;
      const { childCount, childStart } = nodeOf(node);
      if (childCount === 0) {
        leaves.push(node);
        continue;
      }
      checkFamily(node, childStart, childCount, nodeCount, file);
      if (childStart >= base && childStart + childCount <= end) families.push([childStart, childCount]);
      else outside.push(node);
    }
  }
  const nodes = Uint32Array.from(outside).sort();
  return { leaves: Uint32Array.from(leaves).sort(), inner: innerOf(nodes, nodeOf, chunkSize), contained };
}

/** Groups nodes by the chunks of their children. */
function innerOf(
  nodes: Uint32Array,
  nodeOf: (node: number) => { readonly childCount: number; readonly childStart: number },
  chunkSize: number,
): DividedPart['inner'] {
  const groups = new Map<string, { chunks: ChunkRange; nodes: number[] }>();
  for (const node of nodes) {
    const { childCount, childStart } = nodeOf(node);
    const first = Math.floor(childStart / chunkSize);
    const last = Math.floor((childStart + childCount - 1) / chunkSize);
    const key = `${first} ${last}`;
    const group = groups.get(key) ?? { chunks: { first, last }, nodes: [] };
    groups.set(key, group);
    group.nodes.push(node);
  }
  const sorted = [...groups.values()].sort(
    (a, b) => a.chunks.first - b.chunks.first || a.chunks.last - b.chunks.last,
  );
  return sorted.map(({ chunks, nodes: own }) => {
    const byStart = own.toSorted((a, b) => nodeOf(a).childStart - nodeOf(b).childStart);
    const below = {
      chunks,
      starts: Uint32Array.from(byStart, (node) => nodeOf(node).childStart),
      counts: Uint32Array.from(byStart, (node) => nodeOf(node).childCount),
    };
    return { nodes: Uint32Array.from(own), below };
  });
}

/** The nodes of a tree that divided parts contain: verifies that no node belongs to two parts. */
export class TakenNodes {
  readonly #file: string;
  /** One bit per node. */
  readonly #taken: Uint32Array;
  #leftCount: number;

  constructor({ nodeCount, file }: TreeShape) {
    this.#file = file;
    // The words of a part's last bits may reach one word beyond.
    this.#taken = new Uint32Array(Math.ceil(nodeCount / 32) + 1);
    this.#leftCount = nodeCount;
  }

  /** Number of nodes that no part contains. */
  get leftCount(): number {
    return this.#leftCount;
  }

  /**
   * Takes the nodes of a part; none if one of them is taken already.
   *
   * @param base index of the part's first chunk's first node.
   * @throws SplatFileError 'damaged' for a node with several parents.
   */
  take(base: number, contained: Uint32Array): void {
    const shift = base & 31;
    const words: [at: number, bits: number][] = [];
    for (const [i, word] of contained.entries()) {
      const at = (base >> 5) + i;
      words.push([at, word << shift]);
      if (shift > 0) words.push([at + 1, word >>> (32 - shift)]);
    }
    for (const [at, bits] of words) {
      const twice = this.#taken[at] & bits;
      if (twice !== 0) throw severalParents(32 * at + 31 - Math.clz32(twice), this.#file);
    }
    for (const [at, bits] of words) {
      this.#taken[at] |= bits;
      for (let left = bits; left !== 0; left &= left - 1) this.#leftCount--;
    }
  }
}

function severalParents(node: number, file: string): SplatFileError {
  return wrongTree(file, `node ${node} has several parents`);
}
