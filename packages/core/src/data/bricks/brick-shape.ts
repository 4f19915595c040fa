import { cellCounts } from '../layout/cell-counts.ts';
import { CHUNK_SPLATS } from '../layout/constants.ts';
import { LEVEL_CONSTANTS } from '../layout/level-structs.ts';
import { chunkCountOf } from '../packing/chunks.ts';

const { CELL_CHILDREN, CELL_ROOTS } = LEVEL_CONSTANTS;

/** Cells of a brick: from `first` up to but not including `end`, at one level. */
export interface BrickCells {
  readonly level: number;
  readonly first: number;
  readonly end: number;
}

/**
 * Which bricks there are, and which cells and leaves they have: all of that follows from the number
 * of splats. Every cell but the last of its level is full.
 */
export class BrickShape {
  readonly brickCount: number;
  /** Cells of each level, the lowest first. */
  readonly cellCounts: readonly number[];
  /** Leaves of the last cell of each level. */
  readonly #lastLeaves: readonly number[];
  /** Number of the first brick of each level. */
  readonly #firstNumbers: readonly number[];

  /** @param splatCount at least 1. */
  constructor(splatCount: number) {
    const counts = cellCounts(chunkCountOf(splatCount));
    const lastLeaves = [splatCount - CHUNK_SPLATS * (counts[0] - 1)];
    for (let level = 1; level < counts.length; level++) {
      const others = counts[level - 1] - 1 - CELL_CHILDREN * (counts[level] - 1);
      lastLeaves.push(CELL_ROOTS * others + Math.min(CELL_ROOTS, lastLeaves[level - 1]));
    }
    const firstNumbers = counts.map(() => 0);
    let next = 1;
    for (let level = counts.length - 2; level >= 0; level--) {
      firstNumbers[level] = next;
      next += counts[level + 1];
    }
    this.cellCounts = counts;
    this.brickCount = next;
    this.#lastLeaves = lastLeaves;
    this.#firstNumbers = firstNumbers;
  }

  cellsOf(number: number): BrickCells {
    let level = this.cellCounts.length - 1;
    if (number === 0) return { level, first: 0, end: 1 };
    do level--;
    while (number >= this.#firstNumbers[level] + this.cellCounts[level + 1]);
    const first = CELL_CHILDREN * (number - this.#firstNumbers[level]);
    return { level, first, end: Math.min(first + CELL_CHILDREN, this.cellCounts[level]) };
  }

  leavesOf(level: number, cell: number): number {
    return cell + 1 < this.cellCounts[level] ? CHUNK_SPLATS : this.#lastLeaves[level];
  }

  /** Leaves of a brick: all places but the last are full. */
  leafCountOf({ level, first, end }: BrickCells): number {
    return CHUNK_SPLATS * (end - first - 1) + this.leavesOf(level, end - 1);
  }

  rootsOf(level: number, cell: number): number {
    return Math.min(CELL_ROOTS, this.leavesOf(level, cell));
  }

  /** Of each cell below a cell of an upper level: how many roots it has. */
  childRootsOf(level: number, cell: number): number[] {
    const first = CELL_CHILDREN * cell;
    const count = Math.min(CELL_CHILDREN, this.cellCounts[level - 1] - first);
    return Array.from({ length: count }, (_, i) => this.rootsOf(level - 1, first + i));
  }

  /** Number of the brick with the cells below a cell of an upper level. */
  childOf(level: number, cell: number): number {
    return this.#firstNumbers[level - 1] + cell;
  }
}
