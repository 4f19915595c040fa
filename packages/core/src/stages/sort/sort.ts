import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { SortPlan } from '../../data/layout/structs.ts';
import {
  type BallotDevice,
  hasNarrowSubgroups,
  NARROW_SUBGROUP,
  type SubgroupSizes,
} from '../../gpu/device.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import { engineTexts } from '../family-texts.ts';

/** Division of keys into digits and blocks. */
export interface SortShape {
  /** Bits per pass. */
  readonly digitBits: number;
  readonly passes: number;
  /** Threads per workgroup, a multiple of 32. */
  readonly workgroup: number;
  /** Keys per thread; a block has the keys of a workgroup, or of one thread if `isNarrow`. */
  readonly itemsPerThread: number;
  /**
   * Whether few threads of the device run in lockstep: one of them then sorts a block by itself,
   * because barriers take long.
   */
  readonly isNarrow: boolean;
  /** Possible sizes of the device's subgroups, to rank keys by ballots; null: by masks. */
  readonly subgroups: SubgroupSizes | null;
}

/** Threads that rank keys together by masks: a bit each in half of a word. */
const MASK_GROUP = 16;

/** Workgroup memory of every WebGPU device: the default `maxComputeWorkgroupStorageSize`. */
export const DEFAULT_WORKGROUP_BYTES = 16_384;

/** Threads and keys per thread: the first that fit the workgroup memory are taken. */
const BLOCKS = [
  [256, 16],
  [256, 12],
  [192, 24],
  [192, 16],
  [96, 32],
] as const;

/** Where a thread sorts a block by itself: some blocks in small sorts, few counts in large ones. */
const NARROW_BLOCK = [NARROW_SUBGROUP, 1024] as const;

/** The same for ballots. On an H200, 6 million random 32-bit keys took 0.44 ms, 0.51 by masks. */
export const BALLOT_BLOCKS = [
  [512, 8],
  [256, 8],
] as const;

/** Returns the shape as constants for the sort's shaders. */
export function sortConstants(shape: SortShape) {
  const { digitBits, workgroup, itemsPerThread, subgroups } = shape;
  return {
    SORT_GROUP: subgroups?.min ?? MASK_GROUP,
    DIGIT_BITS: digitBits,
    SORT_WORKGROUP: workgroup,
    SORT_ITEMS: itemsPerThread,
    SORT_BLOCK: blockKeysOf(shape),
    SORT_ROWS: rowsOf(shape),
    SORT_THREAD_DIGITS: Math.ceil(2 ** digitBits / workgroup),
  };
}

/** Bits of a word of a key. */
const WORD_BITS = 32;

/** Passes over the lower words of wide keys; null if keys have one word. */
export function lowerPassesOf({ digitBits, passes }: Pick<SortShape, 'digitBits' | 'passes'>): number | null {
  return passes * digitBits > WORD_BITS ? WORD_BITS / digitBits : null;
}

/** The part of a shape that the number of keys per block follows from. */
export type BlockShape = Pick<SortShape, 'workgroup' | 'itemsPerThread' | 'isNarrow'>;

/** Number of keys per block: one workgroup of a pass takes one block, or one thread. */
export function blockKeysOf({ workgroup, itemsPerThread, isNarrow }: BlockShape): number {
  return isNarrow ? itemsPerThread : workgroup * itemsPerThread;
}

/** The words of the `SortPlan` of `keyCount` keys. */
export function sortPlanOf(keyCount: number, shape: BlockShape): Uint32Array {
  return new Uint32Array(SortPlan.pack({ keyCount, blockCount: Math.ceil(keyCount / blockKeysOf(shape)) }));
}

/** Words per digit in which sort-scatter counts keys: of one group by masks, of two by ballots. */
function rowsOf({ workgroup, subgroups }: Pick<SortShape, 'workgroup' | 'subgroups'>): number {
  return Math.ceil(subgroups ? workgroup / subgroups.min / 2 : workgroup / MASK_GROUP);
}

/** Bytes of workgroup memory that sort-scatter, the stage that needs most, declares. */
export function workgroupBytesOf(shape: Omit<SortShape, 'passes'>): number {
  const { workgroup, subgroups } = shape;
  const radix = 2 ** shape.digitBits;
  const words = Math.max(blockKeysOf(shape), rowsOf(shape) * radix) + radix;
  const sums = subgroups ? workgroup / subgroups.min : workgroup + workgroup / MASK_GROUP;
  return 4 * words + 8 * sums + (subgroups ? 4 : 0);
}

/** The properties of a device that the shapes of its sorts follow from. */
export interface SortDevice {
  /** Its `maxComputeWorkgroupStorageSize`: larger blocks give longer runs of keys to write. */
  readonly workgroupBytes: number;
  /** Its `hasNarrowSubgroups`. */
  readonly isNarrow: boolean;
  /** Itself, if keys are to be ranked by ballots as far as its memory allows. */
  readonly ballots: BallotDevice | null;
}

/** @param ballots see `SortDevice`; default null. */
export function sortDeviceOf(device: GPUDevice, ballots: BallotDevice | null = null): SortDevice {
  const { maxComputeWorkgroupStorageSize: workgroupBytes } = device.limits;
  return { workgroupBytes, isNarrow: hasNarrowSubgroups(device), ballots };
}

const ANY_DEVICE: SortDevice = { workgroupBytes: DEFAULT_WORKGROUP_BYTES, isNarrow: false, ballots: null };

/**
 * Chooses the shape with the fewest passes for keys below 2^keyBits; above 2^32 they have two words.
 *
 * @param device default: any.
 */
export function sortShapeFor(keyBits: number, device: Partial<SortDevice> = {}): SortShape {
  // Wide keys are sorted by one word after the other, with the same digits.
  if (keyBits > WORD_BITS) return shapeOf(8, Math.ceil(keyBits / 8), device);
  // Digits of 9 bits take twice the workgroup memory per thread, but save a pass here. Drivers on a
  // CPU take longer to compile the shaders for them, which no sort of pairs shares, than for many
  // such passes.
  if (keyBits > 24 && keyBits <= 27 && !device.isNarrow) return shapeOf(9, 3, device);
  return shapeOf(8, Math.max(1, Math.ceil(keyBits / 8)), device);
}

/**
 * Chooses the shape with the fewest passes, one or two, for keys below 2^keyBits with at most 18
 * bits. Digits have 8 bits where that suffices, as in most sorts of depths: the shaders of both
 * sorts are then the same, and compile once.
 *
 * @param device default: any.
 */
export function pairSortShapeFor(keyBits: number, device: Partial<SortDevice> = {}): SortShape {
  if (keyBits > 18) throw new RangeError(`Keys of ${keyBits} bits take more than two passes; 18 do not.`);
  const passes = keyBits <= 9 ? 1 : 2;
  return shapeOf(keyBits <= 8 * passes ? 8 : 9, passes, device);
}

function shapeOf(digitBits: number, passes: number, device: Partial<SortDevice>): SortShape {
  const { workgroupBytes, isNarrow, ballots } = { ...ANY_DEVICE, ...device };
  const shapesOf = (blocks: readonly (readonly [number, number])[], subgroups: SubgroupSizes | null) =>
    blocks.map(([workgroup, itemsPerThread]) => ({
      digitBits,
      passes,
      workgroup,
      itemsPerThread,
      isNarrow,
      subgroups,
    }));
  if (isNarrow) return shapesOf([NARROW_BLOCK], null)[0];
  const byBallots = ballots
    ? shapesOf(BALLOT_BLOCKS, { min: ballots.min, max: ballots.max }).filter(
        ({ workgroup }) => workgroup <= ballots.workgroupThreads,
      )
    : [];
  const byMasks = shapesOf(BLOCKS, null);
  const shape = [...byBallots, ...byMasks].find((each) => workgroupBytesOf(each) <= workgroupBytes);
  if (shape) return shape;
  throw new RangeError(
    `Digits of ${digitBits} bits need ${workgroupBytesOf(byMasks.at(-1)!)} bytes of workgroup memory, not ${workgroupBytes}.`,
  );
}

/** Counts the digits of each block of keys. */
export function sortHistogram(shape: SortShape): StageDefinition {
  return computeStage('sort-histogram', {
    texts: engineTexts,
    conditions: { NARROW: shape.isNarrow },
    constants: sortConstants(shape),
  });
}

const { SCAN_WORKGROUP, SCAN_ITEMS } = SHADER_CONSTANTS;

/** Replaces each digit's counts by their exclusive sums over all blocks; writes digits' totals. */
export function sortScan({ digitBits }: Pick<SortShape, 'digitBits'>): StageDefinition {
  return computeStage('sort-scan', {
    texts: engineTexts,
    constants: { DIGIT_BITS: digitBits },
  });
}

/** Most counts that one thread scans alone. */
const MAX_ALONE = 64;

/**
 * Number of threads that scan one digit's counts: 1 for few, otherwise 16 to 256, enough for
 * `maxBlocks` counts at a time. Always 1 where few threads run in lockstep, because one thread needs
 * no barriers: for few blocks, SwiftShader took 140 ms with 256 threads per digit, 5 ms with 16 and
 * 0.2 ms with one.
 */
export function scanLanesFor(maxBlocks: number, isNarrow: boolean): number {
  if (isNarrow || maxBlocks <= MAX_ALONE) return 1;
  let lanes = 16;
  while (lanes < SCAN_WORKGROUP && lanes * SCAN_ITEMS < maxBlocks) lanes *= 2;
  return lanes;
}

/** Number of workgroups that scan all digits. */
export function scanWorkgroups({ digitBits }: Pick<SortShape, 'digitBits'>, scanLanes: number): number {
  return Math.ceil((2 ** digitBits * scanLanes) / SCAN_WORKGROUP);
}

/** Moves keys and payloads to their places; each pass may make the payloads, and write the keys. */
export function sortScatter(shape: SortShape): StageDefinition {
  return computeStage('sort-scatter', {
    texts: engineTexts,
    conditions: {
      NARROW: shape.isNarrow,
      SUBGROUPS: shape.subgroups !== null,
      WIDE_SUBGROUPS: (shape.subgroups?.max ?? 0) > 32,
    },
    usesSubgroups: shape.subgroups !== null,
    constants: sortConstants(shape),
  });
}
