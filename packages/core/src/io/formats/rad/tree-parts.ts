import { checkFamily, wrongTree } from './tree-check.ts';

/** Nodes of a chunk, reduced to the tree structure. */
export interface TreeNodes {
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

/** The drawn nodes of a part, as ascending node indices. */
export interface DividedPart {
  /** Nodes without children. */
  readonly leaves: Uint32Array;
  /** Nodes whose children lie in other chunks, grouped by the child parts; nearest chunks first. */
  readonly inner: readonly { readonly nodes: Uint32Array; readonly below: TreePart }[];
}

/** The part that contains the root, in the first chunk. */
export const ROOT_PART: TreePart = {
  chunks: { first: 0, last: 0 },
  starts: Uint32Array.of(0),
  counts: Uint32Array.of(1),
};

/** Divides the parts of a tree, and verifies that no node belongs to two parts. */
export class TreeDivider {
  readonly #nodeCount: number;
  readonly #chunkSize: number;
  readonly #file: string;
  /** Per chunk, one bit per node: whether a divided part contains it. */
  readonly #taken = new Map<number, Uint8Array>();
  #takenCount = 0;

  constructor(nodeCount: number, chunkSize: number, file: string) {
    this.#nodeCount = nodeCount;
    this.#chunkSize = chunkSize;
    this.#file = file;
  }

  /** Number of nodes that no divided part contains. */
  get leftCount(): number {
    return this.#nodeCount - this.#takenCount;
  }

  /**
   * Divides a part.
   *
   * @param chunks the chunks of the part.
   * @param isFirst whether the part is divided for the first time.
   * @throws SplatFileError 'damaged' for misplaced children, or for a child with several parents.
   */
  divide({ starts, counts }: TreePart, chunks: readonly TreeNodes[], isFirst: boolean): DividedPart {
    const [{ base }] = chunks;
    const { base: lastBase, count: lastCount } = chunks.at(-1)!;
    const end = lastBase + lastCount;
    const leaves: number[] = [];
    const outside: number[] = [];
    const families: [number, number][] = [...starts].map((start, i) => [start, counts[i]]);
    const nodeOf = (node: number) => {
      const { base: first, childCounts, childStarts } = chunks[Math.floor((node - base) / this.#chunkSize)];
      return { childCount: childCounts[node - first], childStart: childStarts[node - first] };
    };
    for (let family = families.pop(); family; family = families.pop()) {
      for (let node = family[0]; node < family[0] + family[1]; node++) {
        if (isFirst) this.#take(node);
        const { childCount, childStart } = nodeOf(node);
        if (childCount === 0) {
          leaves.push(node);
          continue;
        }
        checkFamily(node, childStart, childCount, this.#nodeCount, this.#file);
        if (childStart >= base && childStart + childCount <= end) families.push([childStart, childCount]);
        else outside.push(node);
      }
    }
    const nodes = Uint32Array.from(outside).sort();
    return { leaves: Uint32Array.from(leaves).sort(), inner: this.#innerOf(nodes, nodeOf) };
  }

  /** Groups nodes by the chunks of their children. */
  #innerOf(
    nodes: Uint32Array,
    nodeOf: (node: number) => { childCount: number; childStart: number },
  ): DividedPart['inner'] {
    const groups = new Map<string, { chunks: ChunkRange; nodes: number[] }>();
    for (const node of nodes) {
      const { childCount, childStart } = nodeOf(node);
      const first = Math.floor(childStart / this.#chunkSize);
      const last = Math.floor((childStart + childCount - 1) / this.#chunkSize);
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

  #take(node: number): void {
    const chunk = Math.floor(node / this.#chunkSize);
    const taken = this.#taken.get(chunk) ?? new Uint8Array(Math.ceil(this.#chunkSize / 8));
    this.#taken.set(chunk, taken);
    const at = node - chunk * this.#chunkSize;
    const bit = 1 << (at & 7);
    if (taken[at >> 3] & bit) throw wrongTree(this.#file, `node ${node} has several parents`);
    taken[at >> 3] |= bit;
    this.#takenCount++;
  }
}
