import { InvalidArgumentError } from '../errors.ts';
import { given, wrongArgument } from '../given.ts';
import { cellCounts } from '../layout/cell-counts.ts';
import { CHUNK_WORDS } from '../layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../layout/constants.ts';
import { fromHalfBits } from '../layout/half.ts';
import { LEVEL_CONSTANTS } from '../layout/level-structs.ts';
import { chunkCountOf, logScalesOf, maxScaleOf } from '../packing/chunks.ts';
import { GEOMETRY_WORDS, unpackRotation } from '../packing/geometry.ts';
import {
  type Harmonics,
  isPalette,
  type PackedHarmonics,
  packCoefficients,
  readCoefficients,
  shWordsPerSplat,
} from '../packing/harmonics.ts';
import { packSet } from '../packing/pack-set.ts';
import type { PackedCloud } from '../packing/packed-cloud.ts';
import { BLOB_PRECISION } from '../packing/precision.ts';
import { coefficientsPerSplat, type SplatSet } from '../splats/splat-set.ts';
import type { Turns } from '../turns.ts';
import type { Brick, BrickAddress, BrickCell, BrickScene } from './brick.ts';
import { CellMerger, emptyLeaf, type MergedLeaf } from './cell-merger.ts';

const { CELL_CHILDREN, CELL_ROOTS } = LEVEL_CONSTANTS;
const { minPosition, maxPosition } = CHUNK_WORDS;
/** Words of a leaf on the lowest level, and above. */
const SPLAT_WORDS = GEOMETRY_WORDS.packed;
const BLOB_WORDS = GEOMETRY_WORDS[BLOB_PRECISION.geometryPrecision];
/** Where the sums of a blob are among its words. */
const RIM_WORD = 11;
const OPACITY_WORD = 15;
/** Words of the bounds of a cell: least x, y, z, then largest. */
const BOUNDS_WORDS = 6;
/** Cells between two turns of the event loop: each takes some tenths of a millisecond. */
const STEP_CELLS = 16;

/** All cells of one level. */
interface CellLevel {
  readonly count: number;
  /** BOUNDS_WORDS per cell. */
  readonly bounds: Float32Array;
  /** Largest standard deviation of the splats of each cell. */
  readonly largestScales: Float32Array;
  /** Of each cell: its error as in links, and its roots; 0 for the cell at the top. */
  readonly errors: Uint16Array;
  readonly roots: Uint8Array;
  /** Its leaves, a chunk per cell; empty on level 0, whose leaves are the splats. */
  readonly geometry: Uint32Array<ArrayBuffer>;
  readonly harmonics: Uint32Array<ArrayBuffer>;
  /** Leaves of the last cell: all others have CHUNK_SPLATS. */
  readonly lastLeaves: number;
}

/** A scene in memory that is divided into bricks. */
export class MadeBricks {
  readonly cloud: PackedCloud;
  readonly brickCount: number;
  readonly #levels: readonly CellLevel[];
  /** Number of the first brick of each level, the lowest first. */
  readonly #firstNumbers: readonly number[];
  readonly #offsets: Float64Array;

  /** @param levels from the lowest on. */
  constructor(cloud: PackedCloud, levels: readonly CellLevel[]) {
    this.cloud = cloud;
    this.#levels = levels;
    const firstNumbers = levels.map(() => 0);
    let next = 1;
    for (let level = levels.length - 2; level >= 0; level--) {
      firstNumbers[level] = next;
      next += levels[level + 1].count;
    }
    this.#firstNumbers = firstNumbers;
    this.brickCount = next;
    this.#offsets = new Float64Array(next + 1);
    for (let number = 0; number < next; number++) {
      const { level, first, end } = this.#cellsOf(number);
      const words = level === 0 ? SPLAT_WORDS + 1 : BLOB_WORDS;
      const bytes = 4 * CHUNK_SPLATS * (end - first) * (words + this.#shWords);
      this.#offsets[number + 1] = this.#offsets[number] + bytes;
    }
  }

  /** Address of a brick, by its bytes in memory. */
  address(number: number): BrickAddress {
    const offset = this.#offsets[number];
    return { number, offset, bytes: this.#offsets[number + 1] - offset };
  }

  /** A copy of a brick. */
  brick(number: number): Brick {
    const { level, first, end } = this.#cellsOf(number);
    const cells: BrickCell[] = [];
    for (let cell = first; cell < end; cell++) cells.push(this.#cell(level, cell));
    if (level === 0) return { level, cells, ...this.#splatsOf(first, end) };
    const { geometry, harmonics } = this.#levels[level];
    const leavesOf = (words: Uint32Array<ArrayBuffer>, each: number) =>
      words.slice(first * CHUNK_SPLATS * each, end * CHUNK_SPLATS * each);
    return {
      level,
      cells,
      geometry: leavesOf(geometry, BLOB_WORDS),
      harmonics: leavesOf(harmonics, this.#shWords),
      rows: new Uint32Array(0),
    };
  }

  /** All bricks from the root on, one at a time. */
  *bricks(): Generator<Brick, void, void> {
    for (let number = 0; number < this.brickCount; number++) yield this.brick(number);
  }

  get #shWords(): number {
    return shWordsPerSplat(this.cloud.harmonics.degree, BLOB_PRECISION.shPrecision);
  }

  #cellsOf(number: number): { readonly level: number; readonly first: number; readonly end: number } {
    let level = this.#levels.length - 1;
    if (number === 0) return { level, first: 0, end: 1 };
    do level--;
    while (number >= this.#firstNumbers[level] + this.#levels[level + 1].count);
    const first = CELL_CHILDREN * (number - this.#firstNumbers[level]);
    return { level, first, end: Math.min(first + CELL_CHILDREN, this.#levels[level].count) };
  }

  #cell(level: number, cell: number): BrickCell {
    const { bounds, count, lastLeaves, largestScales } = this.#levels[level];
    const [minX, minY, minZ, maxX, maxY, maxZ] = bounds.subarray(BOUNDS_WORDS * cell);
    const { min, step } = level === 0 ? logScalesOf(this.cloud.geometry.chunks, cell) : { min: 0, step: 0 };
    const below = this.#levels[level - 1];
    const [first, end] = [CELL_CHILDREN * cell, CELL_CHILDREN * (cell + 1)];
    return {
      bounds: { min: [minX, minY, minZ], max: [maxX, maxY, maxZ] },
      largestScale: largestScales[cell],
      leafCount: cell + 1 < count ? CHUNK_SPLATS : lastLeaves,
      logScales: [min, step],
      child: below ? this.address(this.#firstNumbers[level - 1] + cell) : null,
      childErrors: below ? Array.from(below.errors.subarray(first, end)) : [],
      childRoots: below ? Array.from(below.roots.subarray(first, end)) : [],
    };
  }

  #splatsOf(first: number, end: number): Pick<Brick, 'geometry' | 'harmonics' | 'rows'> {
    const { count, geometry, harmonics, fileIndices } = this.cloud;
    const [from, to] = [CHUNK_SPLATS * first, Math.min(CHUNK_SPLATS * end, count)];
    const places = CHUNK_SPLATS * (end - first);
    const copied = (words: Uint32Array, each: number) => {
      const copy = new Uint32Array(places * each);
      copy.set(words.subarray(from * each, to * each));
      return copy;
    };
    const shWords = this.#shWords;
    let packed: Uint32Array<ArrayBuffer>;
    if (!isPalette(harmonics)) packed = copied(harmonics.words, shWords);
    else {
      packed = new Uint32Array(places * shWords);
      const { degree } = harmonics;
      const values = new Float64Array(coefficientsPerSplat(degree));
      for (let i = from; i < to; i++) {
        readCoefficients(harmonics, i, values);
        packCoefficients(degree, BLOB_PRECISION.shPrecision, values, packed, (i - from) * shWords);
      }
    }
    return { geometry: copied(geometry.words, SPLAT_WORDS), harmonics: packed, rows: copied(fileIndices, 1) };
  }
}

/**
 * Divides splats into bricks: in Morton order, in chunks of 256, which are merged to sixteen roots
 * each, level by level. Holds the packed splats, about 90 bytes of each at degree 3, besides `set`.
 *
 * @throws InvalidArgumentError 'set' if there are no splats, or some that are not finite.
 */
export function makeBricks(set: SplatSet<Harmonics>): MadeBricks {
  const steps = brickSteps(set);
  for (;;) {
    const { done, value } = steps.next();
    if (done) return value;
  }
}

/**
 * As `makeBricks`, with turns for the event loop. Rejects with the reason of the turns' signal.
 *
 * @param onProgress told how much of the work is done, from 0 to 1.
 */
export async function makeBricksInTurns(
  set: SplatSet<Harmonics>,
  turns: Turns,
  onProgress?: (fraction: number) => void,
): Promise<MadeBricks> {
  const steps = brickSteps(set);
  for (;;) {
    const { done, value } = steps.next();
    if (done) return value;
    onProgress?.(value);
    await turns.give();
  }
}

/** A scene in memory, in bricks: as if they were in a file. @throws as `makeBricks`. */
export function brickSceneOf(
  set: SplatSet<Harmonics>,
  options: { /** Default `scene`. */ readonly name?: string } = {},
): BrickScene {
  const { name = 'scene' } = given(options, { name: 'a string?' });
  const made = makeBricks(set);
  const { count, origin, bounds, robustBounds, harmonics } = made.cloud;
  return {
    name,
    splatCount: count,
    brickCount: made.brickCount,
    shDegree: harmonics.degree,
    origin,
    bounds,
    robustBounds,
    root: made.address(0),
    read: async ({ number }, signal) => {
      signal?.throwIfAborted();
      if (!(Number.isInteger(number) && number >= 0 && number < made.brickCount))
        throw wrongArgument('address.number', number, `from 0 to ${made.brickCount - 1}`, name);
      return made.brick(number);
    },
  };
}

/** Divides splats in short steps; yields how much is done after each. */
function* brickSteps(set: SplatSet<Harmonics>): Generator<number, MadeBricks, void> {
  const precision = { geometryPrecision: 'packed', shPrecision: BLOB_PRECISION.shPrecision } as const;
  const cloud = packSet(set, precision);
  if (cloud.count === 0) throw new InvalidArgumentError('set', 'There are no splats to divide into bricks.');
  if (cloud.count < set.count) {
    const message = `${set.count - cloud.count} of ${set.count} splats have values that are not finite. Leave them out.`;
    throw new InvalidArgumentError('set', message);
  }
  const counts = cellCounts(chunkCountOf(cloud.count));
  const total = counts.reduce((sum, count) => sum + count, 0);
  const lastLeaves = cloud.count - CHUNK_SPLATS * (counts[0] - 1);
  const levels: CellLevel[] = [levelOfChunks(cloud, counts[0], lastLeaves)];
  const merger = new CellMerger();
  let merged = 0;
  for (let level = 0; level + 1 < counts.length; level++) {
    const own = levels[level];
    const above = emptyLevel(cloud, counts[level + 1], own);
    const read = level === 0 ? splatReader(cloud) : blobReader(cloud, own);
    const below = levels[level - 1];
    for (let cell = 0; cell < own.count; cell++) {
      mergeCell(merger, own, cell, below, read, above);
      if (++merged % STEP_CELLS === 0) yield merged / total;
    }
    levels.push(above);
  }
  return new MadeBricks(cloud, levels);
}

function levelOfChunks({ geometry: { chunks } }: PackedCloud, count: number, lastLeaves: number): CellLevel {
  const bounds = new Float32Array(BOUNDS_WORDS * count);
  const largestScales = Float32Array.from({ length: count }, (_, chunk) => maxScaleOf(chunks, chunk));
  for (let chunk = 0; chunk < count; chunk++) {
    const at = chunk * CHUNK_WORDS.count;
    bounds.set(chunks.subarray(at + minPosition, at + minPosition + 3), BOUNDS_WORDS * chunk);
    bounds.set(chunks.subarray(at + maxPosition, at + maxPosition + 3), BOUNDS_WORDS * chunk + 3);
  }
  return {
    ...{ count, bounds, largestScales, lastLeaves },
    errors: new Uint16Array(count),
    roots: new Uint8Array(count),
    geometry: new Uint32Array(0),
    harmonics: new Uint32Array(0),
  };
}

/** A level whose leaves are to be the roots of the one below. */
function emptyLevel({ harmonics: { degree } }: PackedCloud, count: number, below: CellLevel): CellLevel {
  const bounds = new Float32Array(BOUNDS_WORDS * count);
  const largestScales = new Float32Array(count);
  for (let cell = 0; cell < below.count; cell++) {
    const isFirst = cell % CELL_CHILDREN === 0;
    const parent = Math.floor(cell / CELL_CHILDREN);
    largestScales[parent] = Math.max(largestScales[parent], below.largestScales[cell]);
    const [from, to] = [BOUNDS_WORDS * cell, BOUNDS_WORDS * parent];
    for (let k = 0; k < BOUNDS_WORDS; k++) {
      const wider = k < 3 ? Math.min : Math.max;
      bounds[to + k] = isFirst ? below.bounds[from + k] : wider(bounds[to + k], below.bounds[from + k]);
    }
  }
  // Cells with fewer leaves than roots keep them all.
  const lastRoots = Math.min(CELL_ROOTS, below.lastLeaves);
  return {
    ...{ count, bounds, largestScales },
    lastLeaves: CELL_ROOTS * (below.count - 1 - CELL_CHILDREN * (count - 1)) + lastRoots,
    errors: new Uint16Array(count),
    roots: new Uint8Array(count),
    geometry: new Uint32Array(count * CHUNK_SPLATS * BLOB_WORDS),
    harmonics: new Uint32Array(count * CHUNK_SPLATS * shWordsPerSplat(degree, BLOB_PRECISION.shPrecision)),
  };
}

/** How leaves of a level are read, by their number on it. */
interface LeafReader {
  readonly harmonics: Harmonics;
  geometry(leaf: number, result: MergedLeaf): void;
}

/** Merges one cell, and makes its roots leaves of the level above. */
function mergeCell(
  merger: CellMerger,
  own: CellLevel,
  cell: number,
  below: CellLevel | undefined,
  { harmonics, geometry }: LeafReader,
  above: CellLevel,
): void {
  const leafCount = cell + 1 < own.count ? CHUNK_SPLATS : own.lastLeaves;
  const leaf = emptyLeaf();
  merger.begin();
  for (let i = 0; i < leafCount; i++) {
    geometry(cell * CHUNK_SPLATS + i, leaf);
    merger.add(leaf, below ? below.errors[CELL_CHILDREN * cell + Math.floor(i / CELL_ROOTS)] : 0);
  }
  const rootCount = merger.merge();
  own.errors[cell] = merger.error;
  own.roots[cell] = rootCount;
  const start = CELL_ROOTS * cell;
  const bounds = own.bounds.subarray(BOUNDS_WORDS * cell, BOUNDS_WORDS * (cell + 1));
  for (let root = 0; root < rootCount; root++) {
    merger.root(root, leaf);
    packBlob(leaf, bounds, above.geometry, (start + root) * BLOB_WORDS);
  }
  const { degree } = harmonics;
  if (degree === 0) return;
  const width = coefficientsPerSplat(degree);
  const values = new Float64Array(width);
  const sums = new Float64Array(CELL_ROOTS * width);
  for (let i = 0; i < leafCount; i++) {
    readCoefficients(harmonics, cell * CHUNK_SPLATS + i, values);
    const share = merger.shareOf(i);
    const to = merger.rootOf(i) * width;
    for (let k = 0; k < width; k++) sums[to + k] += share * values[k];
  }
  const shWords = shWordsPerSplat(degree, BLOB_PRECISION.shPrecision);
  for (let root = 0; root < rootCount; root++) {
    const own = sums.subarray(root * width, (root + 1) * width);
    packCoefficients(degree, BLOB_PRECISION.shPrecision, own, above.harmonics, (start + root) * shWords);
  }
}

/** Reads splats as shaders unpack them. */
function splatReader({ geometry: { words, chunks }, harmonics }: PackedCloud): LeafReader {
  const floats = new Float32Array(words.buffer, words.byteOffset, words.length);
  const ranges = Array.from({ length: chunks.length / CHUNK_WORDS.count }, (_, i) => logScalesOf(chunks, i));
  return {
    harmonics,
    geometry(splat, result) {
      const at = splat * SPLAT_WORDS;
      const { min, step } = ranges[Math.floor(splat / CHUNK_SPLATS)];
      const { position, rotation, scale, colorDc } = result;
      for (let axis = 0; axis < 3; axis++) position[axis] = floats[at + axis];
      result.opacity = (words[at + 4] >>> 16) / 65535;
      scale[0] = Math.exp(min + step * (words[at + 5] & 0xffff));
      scale[1] = Math.exp(min + step * (words[at + 5] >>> 16));
      scale[2] = Math.exp(min + step * (words[at + 6] & 0xffff));
      unpackRotation(words[at + 6] >>> 16, words[at + 7], rotation);
      colorDc[0] = fromHalfBits(words[at + 3] & 0xffff);
      colorDc[1] = fromHalfBits(words[at + 3] >>> 16);
      colorDc[2] = fromHalfBits(words[at + 4] & 0xffff);
    },
  };
}

/** Reads the blobs that are the leaves of an upper level. */
function blobReader({ harmonics: { degree } }: PackedCloud, level: CellLevel): LeafReader {
  const floats = new Float32Array(level.geometry.buffer);
  const precision = BLOB_PRECISION.shPrecision;
  const wordsPerSplat = shWordsPerSplat(degree, precision);
  const harmonics: PackedHarmonics = { degree, precision, wordsPerSplat, words: level.harmonics };
  return {
    harmonics,
    geometry(blob, result) {
      const at = blob * BLOB_WORDS;
      for (let axis = 0; axis < 3; axis++) {
        result.position[axis] = floats[at + axis];
        result.scale[axis] = floats[at + 8 + axis];
        result.colorDc[axis] = floats[at + 12 + axis];
      }
      result.opacity = floats[at + 3];
      for (let k = 0; k < 4; k++) result.rotation[k] = floats[at + 4 + k];
      result.sums[0] = floats[at + RIM_WORD];
      result.sums[1] = floats[at + OPACITY_WORD];
    },
  };
}

/** Packs a blob as float32 geometry, with its sums in the words that splats leave empty. */
function packBlob(blob: MergedLeaf, bounds: Float32Array, words: Uint32Array<ArrayBuffer>, at: number): void {
  const floats = new Float32Array(words.buffer, 4 * at, BLOB_WORDS);
  for (let axis = 0; axis < 3; axis++) {
    // Rounding must not move it out of the cell.
    floats[axis] = Math.max(bounds[axis], Math.min(bounds[3 + axis], blob.position[axis]));
    floats[8 + axis] = blob.scale[axis];
    floats[12 + axis] = blob.colorDc[axis];
  }
  floats[3] = blob.opacity;
  floats.set(blob.rotation, 4);
  floats[RIM_WORD] = blob.sums[0];
  floats[OPACITY_WORD] = blob.sums[1];
}
