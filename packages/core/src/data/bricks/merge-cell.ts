import { LEVEL_CONSTANTS } from '../layout/level-structs.ts';
import { type Harmonics, packCoefficients, readCoefficients, shWordsPerSplat } from '../packing/harmonics.ts';
import { BLOB_PRECISION } from '../packing/precision.ts';
import { coefficientsPerSplat } from '../splats/splat-set.ts';
import { type CellMerger, emptyLeaf } from './cell-merger.ts';
import { BLOB_WORDS, type LeafReader, packBlob } from './leaf-reader.ts';

const { CELL_ROOTS } = LEVEL_CONSTANTS;

/** Leaves of some cells. */
export interface Leaves {
  readonly read: LeafReader;
  readonly harmonics: Harmonics;
}

/** The leaves of one cell. */
export interface CellLeaves extends Leaves {
  /** Index of the cell's first leaf in the arrays that `read` reads from. */
  readonly first: number;
  readonly count: number;
  /** Errors of the child cells, whose roots the leaves are; undefined if the leaves are splats. */
  readonly childErrors: Uint16Array | undefined;
  /** Least x, y, z, then largest. */
  readonly bounds: Float32Array;
}

/** Blobs, as leaves of upper levels. */
export interface Blobs {
  readonly geometry: Uint32Array<ArrayBuffer>;
  readonly harmonics: Uint32Array<ArrayBuffer>;
}

/** Merges one cell, and writes its roots as blobs from `firstRoot` on. Returns the cell's error. */
export function mergeCell(
  merger: CellMerger,
  { read, harmonics, first, count, childErrors, bounds }: CellLeaves,
  roots: Blobs,
  firstRoot: number,
): number {
  const leaf = emptyLeaf();
  merger.begin();
  for (let i = 0; i < count; i++) {
    read(first + i, leaf);
    merger.add(leaf, childErrors ? childErrors[Math.floor(i / CELL_ROOTS)] : 0);
  }
  const rootCount = merger.merge();
  for (let root = 0; root < rootCount; root++) {
    merger.root(root, leaf);
    // Rounding must not move it out of the cell.
    for (let axis = 0; axis < 3; axis++)
      leaf.position[axis] = Math.max(bounds[axis], Math.min(bounds[3 + axis], leaf.position[axis]));
    packBlob(leaf, roots.geometry, (firstRoot + root) * BLOB_WORDS);
  }
  const { degree } = harmonics;
  if (degree === 0) return merger.error;
  const width = coefficientsPerSplat(degree);
  const values = new Float64Array(width);
  const sums = new Float64Array(CELL_ROOTS * width);
  for (let i = 0; i < count; i++) {
    readCoefficients(harmonics, first + i, values);
    const share = merger.shareOf(i);
    const to = merger.rootOf(i) * width;
    for (let k = 0; k < width; k++) sums[to + k] += share * values[k];
  }
  const shWords = shWordsPerSplat(degree, BLOB_PRECISION.shPrecision);
  for (let root = 0; root < rootCount; root++) {
    const mean = sums.subarray(root * width, (root + 1) * width);
    packCoefficients(degree, BLOB_PRECISION.shPrecision, mean, roots.harmonics, (firstRoot + root) * shWords);
  }
  return merger.error;
}
