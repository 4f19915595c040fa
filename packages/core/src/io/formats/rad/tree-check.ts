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
    if (childStart <= node || childStart + childCount > this.#nodeCount) {
      const found = `the children of node ${node} are ${childStart} to ${childStart + childCount - 1}`;
      throw this.#damaged(`${found}, which must be behind it and within its ${this.#nodeCount} nodes`);
    }
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
    throw this.#damaged(`node ${next} has no parent, or the one before it has several`);
  }

  #damaged(message: string): SplatFileError {
    return new SplatFileError('damaged', this.#file, `its tree is wrong: ${message}. Export it again.`);
  }
}
