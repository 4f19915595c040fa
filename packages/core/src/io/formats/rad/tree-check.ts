import { SplatFileError } from '../../../data/errors.ts';

/** Exceeds every possible number of children. */
const COUNTS = 2 ** 16;

/**
 * Checks the tree of a scene, node by node. Every node but the root, the first, must be the child
 * of exactly one earlier node. This excludes cycles and unreachable nodes.
 */
export class TreeCheck {
  readonly #nodeCount: number;
  readonly #file: string;
  /** Index of the first child and number of children, for each inner node. */
  #families = new Float64Array(1024);
  #length = 0;

  constructor(nodeCount: number, file: string) {
    this.#nodeCount = nodeCount;
    this.#file = file;
  }

  /** Adds an inner node. @throws SplatFileError 'damaged' */
  add(node: number, childStart: number, childCount: number): void {
    checkFamily(node, childStart, childCount, this.#nodeCount, this.#file);
    if (this.#length === this.#families.length) {
      const larger = new Float64Array(2 * this.#length);
      larger.set(this.#families);
      this.#families = larger;
    }
    this.#families[this.#length++] = childStart * COUNTS + childCount;
  }

  /** Called after the last node. @throws SplatFileError 'damaged' */
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

/** @throws SplatFileError 'damaged' unless a node's children follow it and lie in the scene. */
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
