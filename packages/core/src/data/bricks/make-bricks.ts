import { InvalidArgumentError } from '../errors.ts';
import { given, wrongArgument } from '../given.ts';
import { CHUNK_WORDS } from '../layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../layout/constants.ts';
import { LEVEL_CONSTANTS } from '../layout/level-structs.ts';
import { logScalesOf, maxScaleOf } from '../packing/chunks.ts';
import {
  type Harmonics,
  isPalette,
  packCoefficients,
  readCoefficients,
  shWordsPerSplat,
} from '../packing/harmonics.ts';
import { packSet } from '../packing/pack-set.ts';
import type { PackedCloud } from '../packing/packed-cloud.ts';
import { BLOB_PRECISION } from '../packing/precision.ts';
import { givenSet } from '../splats/check-set.ts';
import { checkStill } from '../splats/columns.ts';
import { coefficientsPerSplat, type SplatSet } from '../splats/splat-set.ts';
import type { Brick, BrickAddress, BrickCell, BrickScene } from './brick.ts';
import { BrickShape } from './brick-shape.ts';
import { CellMerger } from './cell-merger.ts';
import { BLOB_WORDS, blobReader, leafReader, SPLAT_WORDS } from './leaf-reader.ts';
import { type Leaves, mergeCell } from './merge-cell.ts';

const { CELL_CHILDREN, CELL_ROOTS } = LEVEL_CONSTANTS;
const { minPosition, maxPosition } = CHUNK_WORDS;
/** Words of the bounds of a cell: least x, y, z, then largest. */
const BOUNDS_WORDS = 6;

/** All cells of one level. */
interface CellLevel {
  /** BOUNDS_WORDS per cell. */
  readonly bounds: Float32Array;
  /** Largest standard deviation of the splats of each cell. */
  readonly largestScales: Float32Array;
  /** Of each cell: its error, as in links; 0 for the cell at the top. */
  readonly errors: Uint16Array;
  /** Its leaves, a chunk per cell; empty on level 0, whose leaves are the splats. */
  readonly geometry: Uint32Array<ArrayBuffer>;
  readonly harmonics: Uint32Array<ArrayBuffer>;
}

/** A scene in memory that is divided into bricks. */
export class MadeBricks {
  readonly cloud: PackedCloud;
  readonly shape: BrickShape;
  readonly #levels: readonly CellLevel[];
  readonly #offsets: Float64Array;

  /** @param levels from the lowest on. */
  constructor(cloud: PackedCloud, shape: BrickShape, levels: readonly CellLevel[]) {
    this.cloud = cloud;
    this.shape = shape;
    this.#levels = levels;
    this.#offsets = new Float64Array(shape.brickCount + 1);
    for (let number = 0; number < shape.brickCount; number++) {
      const { level, first, end } = shape.cellsOf(number);
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
    const { level, first, end } = this.shape.cellsOf(number);
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
      fileIndices: new Uint32Array(0),
    };
  }

  /** All bricks from the root on, one at a time. */
  *bricks(): Generator<Brick, void, void> {
    for (let number = 0; number < this.shape.brickCount; number++) yield this.brick(number);
  }

  get #shWords(): number {
    return shWordsPerSplat(this.cloud.harmonics.degree, BLOB_PRECISION.shPrecision);
  }

  #cell(level: number, cell: number): BrickCell {
    const bounds = this.#levels[level].bounds.subarray(BOUNDS_WORDS * cell, BOUNDS_WORDS * (cell + 1));
    const [minX, minY, minZ, maxX, maxY, maxZ] = bounds;
    const own = {
      largestScale: this.#levels[level].largestScales[cell],
      bounds: { min: [minX, minY, minZ], max: [maxX, maxY, maxZ] },
      leafCount: this.shape.leavesOf(level, cell),
    } as const;
    if (level === 0) {
      const { min, step } = logScalesOf(this.cloud.geometry.chunks, cell);
      return { ...own, logScales: [min, step], child: null, childErrors: [], childRoots: [] };
    }
    const { errors } = this.#levels[level - 1];
    return {
      ...own,
      logScales: [0, 0],
      child: this.address(this.shape.childOf(level, cell)),
      childErrors: Array.from(errors.subarray(CELL_CHILDREN * cell, CELL_CHILDREN * (cell + 1))),
      childRoots: this.shape.childRootsOf(level, cell),
    };
  }

  #splatsOf(first: number, end: number): Pick<Brick, 'geometry' | 'harmonics' | 'fileIndices'> {
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
    return {
      geometry: copied(geometry.words, SPLAT_WORDS),
      harmonics: packed,
      fileIndices: copied(fileIndices, 1),
    };
  }
}

/**
 * Divides splats into bricks: in Morton order, in chunks of 256, which are merged to sixteen roots
 * each, level by level. Holds the packed splats, about 90 bytes of each at degree 3, besides `set`.
 *
 * @throws InvalidArgumentError 'set' if there are no splats, if some are not finite, or if they move.
 */
export function makeBricks(set: SplatSet<Harmonics>): MadeBricks {
  const precision = { geometryPrecision: 'packed', shPrecision: BLOB_PRECISION.shPrecision } as const;
  checkStill(givenSet(set), 'a scene in bricks');
  const cloud = packSet(set, precision);
  if (cloud.count === 0) throw new InvalidArgumentError('set', 'There are no splats to divide into bricks.');
  if (cloud.count < set.count) {
    const message = `${set.count - cloud.count} of ${set.count} splats have values that are not finite. Leave them out.`;
    throw new InvalidArgumentError('set', message);
  }
  const shape = new BrickShape(cloud.count);
  const counts = shape.cellCounts;
  const levels: CellLevel[] = [levelOfChunks(cloud, counts[0])];
  const merger = new CellMerger();
  for (let level = 0; level + 1 < counts.length; level++) {
    const own = levels[level];
    const above = emptyLevel(cloud, counts[level + 1], own);
    const leaves = level === 0 ? splatsOf(cloud) : blobsOf(cloud, own);
    const below = levels[level - 1];
    for (let cell = 0; cell < counts[level]; cell++) {
      own.errors[cell] = mergeCell(
        merger,
        {
          ...leaves,
          first: CHUNK_SPLATS * cell,
          count: shape.leavesOf(level, cell),
          childErrors: below?.errors.subarray(CELL_CHILDREN * cell),
          bounds: own.bounds.subarray(BOUNDS_WORDS * cell, BOUNDS_WORDS * (cell + 1)),
        },
        above,
        CELL_ROOTS * cell,
      );
    }
    levels.push(above);
  }
  return new MadeBricks(cloud, shape, levels);
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
    brickCount: made.shape.brickCount,
    shDegree: harmonics.degree,
    origin,
    bounds,
    robustBounds,
    ...(set.isAntialiased !== undefined && { isAntialiased: set.isAntialiased }),
    root: made.address(0),
    read: async ({ number }, signal) => {
      signal?.throwIfAborted();
      if (!(Number.isInteger(number) && number >= 0 && number < made.shape.brickCount))
        throw wrongArgument('address.number', number, `from 0 to ${made.shape.brickCount - 1}`, name);
      return made.brick(number);
    },
    end: () => {},
  };
}

function splatsOf({ geometry: { words, chunks }, harmonics }: PackedCloud): Leaves {
  const ranges = Array.from({ length: chunks.length / CHUNK_WORDS.count }, (_, i) => logScalesOf(chunks, i));
  return { read: leafReader(words, ranges), harmonics };
}

function blobsOf({ harmonics: { degree } }: PackedCloud, { geometry, harmonics }: CellLevel): Leaves {
  const precision = BLOB_PRECISION.shPrecision;
  const wordsPerSplat = shWordsPerSplat(degree, precision);
  return { read: blobReader(geometry), harmonics: { degree, precision, wordsPerSplat, words: harmonics } };
}

function levelOfChunks({ geometry: { chunks } }: PackedCloud, count: number): CellLevel {
  const bounds = new Float32Array(BOUNDS_WORDS * count);
  for (let chunk = 0; chunk < count; chunk++) {
    const at = chunk * CHUNK_WORDS.count;
    bounds.set(chunks.subarray(at + minPosition, at + minPosition + 3), BOUNDS_WORDS * chunk);
    bounds.set(chunks.subarray(at + maxPosition, at + maxPosition + 3), BOUNDS_WORDS * chunk + 3);
  }
  return {
    bounds,
    largestScales: Float32Array.from({ length: count }, (_, chunk) => maxScaleOf(chunks, chunk)),
    errors: new Uint16Array(count),
    geometry: new Uint32Array(0),
    harmonics: new Uint32Array(0),
  };
}

/** A level whose leaves are to be the roots of the one below. */
function emptyLevel({ harmonics: { degree } }: PackedCloud, count: number, below: CellLevel): CellLevel {
  const bounds = new Float32Array(BOUNDS_WORDS * count);
  for (let at = 0; at < below.bounds.length; at++) {
    const [cell, k] = [Math.floor(at / BOUNDS_WORDS), at % BOUNDS_WORDS];
    const to = BOUNDS_WORDS * Math.floor(cell / CELL_CHILDREN) + k;
    const wider = k < 3 ? Math.min : Math.max;
    bounds[to] = cell % CELL_CHILDREN === 0 ? below.bounds[at] : wider(bounds[to], below.bounds[at]);
  }
  const largestScales = new Float32Array(count);
  for (const [cell, scale] of below.largestScales.entries()) {
    const parent = Math.floor(cell / CELL_CHILDREN);
    largestScales[parent] = Math.max(largestScales[parent], scale);
  }
  return {
    bounds,
    largestScales,
    errors: new Uint16Array(count),
    geometry: new Uint32Array(count * CHUNK_SPLATS * BLOB_WORDS),
    harmonics: new Uint32Array(count * CHUNK_SPLATS * shWordsPerSplat(degree, BLOB_PRECISION.shPrecision)),
  };
}
