import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../../data/layout/level-structs.ts';
import { coefficientsPerSplat, type ShDegree } from '../../../data/splats/splat-set.ts';

/** Bytes of the header of a file. */
export const FILE_HEADER_BYTES = 168;
export const VERSION = 1;
/** Places in the header of a file, which begins with the magic number. */
export const FILE_HEADER = {
  version: 8,
  splatCount: 12,
  brickCount: 20,
  shDegree: 24,
  flags: 25,
  /** 3 × f64. */
  origin: 28,
  /** 6 × f64: least x, y, z, then largest. */
  bounds: 52,
  robustBounds: 100,
  rootOffset: 148,
  rootBytes: 156,
  reserved: 160,
  /** CRC-32 of all bytes of the header before it. */
  crc: 164,
} as const;
/** Flags of a file: whether it says how splats were trained, and whether with antialiasing. */
export const TELLS_ANTIALIASED = 1;
export const IS_ANTIALIASED = 2;

/** Places in the header of a brick, whose cells follow. */
export const BRICK_HEADER = {
  /** CRC-32 of all bytes of the header after it. */
  crc: 0,
  number: 4,
  /** Packed geometry follows the header, and packed harmonics that. */
  geometryBytes: 8,
  harmonicsBytes: 12,
  /** Offset in the file of the brick below the first cell; others follow. 0 on the lowest level. */
  childrenOffset: 16,
  cells: 24,
} as const;
/** Places in each cell of the header of a brick. */
export const CELL = {
  /** 6 × f32: least x, y, z, then largest. */
  bounds: 0,
  /** f32: the largest standard deviation of the splats below, with room for rounded log scales. */
  largestScale: 24,
  bytes: 28,
} as const;
/** Places in each cell of an upper level. */
export const UPPER_CELL = {
  ...CELL,
  /** Bytes of the brick below. */
  childBytes: 28,
  /** u16 of each cell below; 0 where there is none. */
  childErrors: 32,
  bytes: 32 + 2 * LEVEL_CONSTANTS.CELL_CHILDREN,
} as const;

/** Bytes of the header of a brick. */
export function brickHeaderBytes(level: number, cellCount: number): number {
  return BRICK_HEADER.cells + cellCount * (level === 0 ? CELL.bytes : UPPER_CELL.bytes);
}

// Unpacked geometry: the length of a step of colours, f32, then planes, each with a byte for every
// leaf of the brick. Values of two bytes have a plane of high bytes and one of low bytes.

/** Bits of a coordinate in the bounds of its cell. */
export const POSITION_BITS = 14;
/** Steps of log scales per unit. */
export const LOG_SCALE_STEPS = 24;
/** Log scales are rounded by less than half a step. */
export const SCALE_ROUNDING = Math.exp(0.6 / LOG_SCALE_STEPS);
/** Usual length of a step of base colours; colours of more than MOST_COLOR_STEPS make it longer. */
export const COLOR_STEP = 1 / 80;
/** Differences of differences of so many steps fit into 16 bits. */
export const MOST_COLOR_STEPS = 8191;
/** Steps of the components of a rotation, to either side of 0; the largest are √½. */
export const ROTATION_STEPS = 127;
/** Steps of the opacity of splats, and of ln(1 + opacity) of blobs up to MOST_OPACITY. */
export const OPACITY_STEPS = 255;
export const BLOB_OPACITY_STEPS = 4095;
/** Logarithms of the sums of blobs: their steps per unit, and the code of a sum of 1; 0 is none. */
export const SUM_STEPS = 16;
export const SUM_OF_ONE = 2048;
export const MOST_SUM = 4095;

// Unpacked harmonics: the number of components, a byte; the mean of each coefficient, f32; of each
// component its flags, the length of a step, f32, and the axis that it is along, a byte for each
// coefficient. Then planes of the components' values, in steps.

/** Flags of a component: values have two bytes, and are differences, each from the one before. */
export const IS_WIDE = 1;
export const IS_DIFFERENCE = 2;
/** Usual length of a step of harmonics. */
export const HARMONICS_STEP = 1 / 72;
/**
 * Part of a step from which on a value is rounded up. More values are 0 than with a half, which
 * takes 1 % less bytes for the same error.
 */
export const ROUNDED_UP = 0.58;
/** Differences of so many steps fit into 16 bits. */
export const MOST_HARMONICS_STEPS = 16383;
/** The largest number of an axis. */
export const AXIS_STEPS = 127;
/** Bytes of a component before its axis. */
export const COMPONENT_BYTES = 5;
/** Bytes before the means. */
export const HARMONICS_HEAD_BYTES = 1;

/** Bytes of the planes of unpacked geometry, per leaf. */
export const SPLAT_PLANES = 22;
export const BLOB_PLANES = 27;

/** Bytes of the geometry of so many leaves, unpacked. */
export function geometryBytes(level: number, count: number): number {
  return 4 + count * (level === 0 ? SPLAT_PLANES : BLOB_PLANES);
}

/** Bytes of the harmonics of so many leaves, unpacked, at most. */
export function mostHarmonicsBytes(degree: ShDegree, count: number): number {
  const width = coefficientsPerSplat(degree);
  return HARMONICS_HEAD_BYTES + 4 * width + width * (COMPONENT_BYTES + width + 2 * count);
}

/** Most bytes of a brick: whatever is packed takes no more than it is, but for this part. */
const MOST_GROWTH = 1.01;

/** Most bytes that a brick of this level and so many cells takes in a file. */
export function mostBrickBytes(level: number, cellCount: number, degree: ShDegree): number {
  const count = cellCount * CHUNK_SPLATS;
  const unpacked = geometryBytes(level, count) + mostHarmonicsBytes(degree, count);
  return brickHeaderBytes(level, cellCount) + Math.ceil(MOST_GROWTH * unpacked) + 1024;
}
