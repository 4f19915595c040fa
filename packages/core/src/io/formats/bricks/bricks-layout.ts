import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../../data/layout/level-structs.ts';
import { coefficientsPerSplat, type ShDegree } from '../../../data/splats/splat-set.ts';

/** Bytes of the file header. */
export const FILE_HEADER_BYTES = 168;
export const VERSION = 1;
/** Byte offsets in the file header, which begins with the magic number. */
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
  /** CRC-32 of all preceding bytes of the header. */
  crc: 164,
} as const;
/** Flags of a file. This one: the file states whether the splats were trained with an antialias filter. */
export const TELLS_ANTIALIASED = 1;
export const IS_ANTIALIASED = 2;

/** Byte offsets in the header of a brick; its cells follow. */
export const BRICK_HEADER = {
  /** CRC-32 of all following bytes of the header. */
  crc: 0,
  number: 4,
  /** Bytes of the packed geometry, which follows the header. Packed harmonics follow the geometry. */
  geometryBytes: 8,
  harmonicsBytes: 12,
  /** File offset of the first cell's child brick; the other children follow. 0 on the lowest level. */
  childrenOffset: 16,
  cells: 24,
} as const;
/** Byte offsets in a cell of a brick header. */
export const CELL = {
  /** 6 × f32: least x, y, z, then largest. */
  bounds: 0,
  /** f32: largest standard deviation of the splats below, in scene units, with a margin for rounding. */
  largestScale: 24,
  bytes: 28,
} as const;
/** Byte offsets in a cell of an upper level. */
export const UPPER_CELL = {
  ...CELL,
  /** Bytes of the child brick. */
  childBytes: 28,
  /** u16 per child cell; 0 if there is no such child. */
  childErrors: 32,
  bytes: 32 + 2 * LEVEL_CONSTANTS.CELL_CHILDREN,
} as const;

/** Bytes of a brick header. */
export function brickHeaderBytes(level: number, cellCount: number): number {
  return BRICK_HEADER.cells + cellCount * (level === 0 ? CELL.bytes : UPPER_CELL.bytes);
}

// Unpacked geometry: the step of colours as f32, then planes with one byte per leaf of the brick.
// 16-bit values have a plane of high bytes and a plane of low bytes.

/** Bits per coordinate within the bounds of its cell. */
export const POSITION_BITS = 14;
/** Steps of log scales per unit. */
export const LOG_SCALE_STEPS = 24;
/** Bound of the factor by which rounding changes a scale: half a step, with a margin. */
export const SCALE_ROUNDING = Math.exp(0.6 / LOG_SCALE_STEPS);
/** Default step of base colours; longer if a colour would exceed MOST_COLOR_STEPS. */
export const COLOR_STEP = 1 / 80;
/** Second differences of this many steps fit into 16 bits. */
export const MOST_COLOR_STEPS = 8191;
/** Steps of a rotation component on either side of 0; the largest component is √½. */
export const ROTATION_STEPS = 127;
/** Steps of the opacity of splats, and of ln(1 + opacity) of blobs up to MOST_OPACITY. */
export const OPACITY_STEPS = 255;
export const BLOB_OPACITY_STEPS = 4095;
/** Steps per unit of the logarithms of blob sums, and the code of a sum of 1; code 0 is a sum of 0. */
export const SUM_STEPS = 16;
export const SUM_OF_ONE = 2048;
export const MOST_SUM = 4095;

// Unpacked harmonics: the number of components, u8; the mean of each coefficient, f32. Each
// component then has flags, a step as f32, and an axis with one byte per coefficient. Planes of the
// components' values follow, in steps.

/** Flags of a component. This one: values have 16 bits, and are differences from the preceding value. */
export const IS_WIDE = 1;
export const IS_DIFFERENCE = 2;
/** Default step of harmonics. */
export const HARMONICS_STEP = 1 / 72;
/**
 * Fraction of a step from which a value is rounded up. Above one half, more values are 0: this
 * takes 1 % fewer bytes for the same error.
 */
export const ROUNDED_UP = 0.58;
/** Differences of this many steps fit into 16 bits. */
export const MOST_HARMONICS_STEPS = 16383;
/** Largest magnitude of an axis entry. */
export const AXIS_STEPS = 127;
/** Bytes of a component before its axis. */
export const COMPONENT_BYTES = 5;
/** Bytes before the means. */
export const HARMONICS_HEAD_BYTES = 1;

/** Bytes per leaf of the planes of unpacked geometry. */
export const SPLAT_PLANES = 22;
export const BLOB_PLANES = 27;

/** Bytes of the unpacked geometry of this many leaves. */
export function geometryBytes(level: number, count: number): number {
  return 4 + count * (level === 0 ? SPLAT_PLANES : BLOB_PLANES);
}

/** Upper bound of the bytes of the unpacked harmonics of this many leaves. */
export function mostHarmonicsBytes(degree: ShDegree, count: number): number {
  const width = coefficientsPerSplat(degree);
  return HARMONICS_HEAD_BYTES + 4 * width + width * (COMPONENT_BYTES + width + 2 * count);
}

/** Largest ratio of packed to unpacked bytes: incompressible data grow a little. */
const MOST_GROWTH = 1.01;

/** Upper bound of the bytes of a brick in a file. */
export function mostBrickBytes(level: number, cellCount: number, degree: ShDegree): number {
  const count = cellCount * CHUNK_SPLATS;
  const unpacked = geometryBytes(level, count) + mostHarmonicsBytes(degree, count);
  return brickHeaderBytes(level, cellCount) + Math.ceil(MOST_GROWTH * unpacked) + 1024;
}
