import { SplatFileError } from '../../../data/errors.ts';

/** Above the number of children of a node. */
const COUNTS = 2 ** 16;

/**
 * Checks the tree of a scene, whose nodes come one after another: each but the root, the first, is
 * the child of one node before it. So there are no cycles, and each leaf can be reached.
 */
export class TreeCheck {
  readonly #nodeCount: number;
  readonly #file: string;
  /** Of each inner node, its first child and their number. */
  #families = new Float64Array(1024);
  #length = 0;

  constructor(nodeCount: number, file: string) {
    this.#nodeCount = nodeCount;
    this.#file = file;
  }

  /** Takes an inner node. @throws SplatFileError 'damaged' */
  add(node: number, childStart: number, childCount: number): void {
    checkFamily(node, childStart, childCount, this.#nodeCount, this.#file);
    if (this.#length === this.#families.length) {
      const larger = new Float64Array(2 * this.#length);
      larger.set(this.#families);
      this.#families = larger;
    }
    this.#families[this.#length++] = childStart * COUNTS + childCount;
  }

  /** Called when there are no more nodes. @throws SplatFileError 'damaged' */
  finish(): void {
    let next = 1;
    for (const family of this.#families.subarray(0, this.#length).sort()) {
      const start = Math.floor(family / COUNTS);
      if (start !== next) break;
      next += family % COUNTS;
    }
    if (next === this.#nodeCount) return;
    throw wrongTree(this.#file, `node ${next} has no parent, or the one before it has several`);
  }
}

/** @throws SplatFileError 'damaged' unless the children of a node are behind it and in the scene. */
export function checkFamily(
  node: number,
  childStart: number,
  childCount: number,
  nodeCount: number,
  file: string,
): void {
  if (childStart > node && childStart + childCount <= nodeCount) return;
  const found = `the children of node ${node} are ${childStart} to ${childStart + childCount - 1}`;
  throw wrongTree(file, `${found}, which must be behind it and within its ${nodeCount} nodes`);
}

export function wrongTree(file: string, message: string): SplatFileError {
  return new SplatFileError('damaged', file, `its tree is wrong: ${message}. Export it again.`);
}
