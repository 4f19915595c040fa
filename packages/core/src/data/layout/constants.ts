/** Splats per chunk: one workgroup culls one chunk. */
export const CHUNK_SPLATS = 256;

const RANK_SAMPLES = 2048;
const SCAN_WORKGROUP = 256;
const SCAN_GROUP = 16;

/**
 * Constants that shaders import by name (`import constants::CHUNK_SPLATS;`). WebGPU's default limit
 * is 256 threads.
 */
export const SHADER_CONSTANTS = {
  CHUNK_SPLATS,
  /** Words of a chunk's visibility mask, one bit per splat. */
  MASK_WORDS: CHUNK_SPLATS / 32,
  CHUNK_WORKGROUP: 64,
  PROJECT_WORKGROUP: 256,
  /** Side of a tile: one workgroup blends one tile. */
  TILE_PX: 8,
  /** Side of a bin in tiles, and in pixels. Pairs are sorted by bin. */
  BIN_TILES: 8,
  BIN_PX: 64,
  /** Threads of the stages that list pairs. */
  TILE_WORKGROUP: 256,
  /** Ranks per thread, and per workgroup, whose pairs are counted. */
  TILE_COUNT_ITEMS: 4,
  TILE_COUNT_BLOCK: 1024,
  /** Successive pairs that a thread lists at once. */
  TILE_EMIT_RUN: 2,
  /** Ranks of a block that workgroup memory has, where threads look for their pairs. */
  RANK_SAMPLES,
  /** Halvings that leave one of them. */
  RANK_STEPS: Math.log2(RANK_SAMPLES),
  /** Pairs whose masks lie together. */
  MASK_GROUP: 256,
  SCAN_WORKGROUP,
  /** Counts per thread of a scan. */
  SCAN_ITEMS: 8,
  /** Threads of a group: each adds up the sums of those before it in its group. */
  SCAN_GROUP,
  /** Groups of a scan. */
  SCAN_GROUPS: SCAN_WORKGROUP / SCAN_GROUP,
  /** Words of a splat's motion; the GPU reads them by four. */
  MOTION_WORDS: 16,
  /** Words of a chunk's reach in one interval of time: least and greatest displacement, x, y, z. */
  REACH_WORDS: 6,
  /** Intervals of equal length that the time of a moving scene is divided into, to cull chunks by. */
  TIME_INTERVALS: 32,
  /** A splat moves no further when its time is this far away. */
  MOST_ELAPSED: 10_000,
  /**
   * A turn that leaves less of a rotation's length cancels it, and the identity takes its place: such a
   * quaternion has no direction in float32.
   */
  LEAST_ROTATION: 2 ** -20,
  /** Side of the square of pixels that one workgroup composites or enlarges. */
  IMAGE_TILE_PX: 8,
} as const;

/** Counts that one workgroup scans at a time. */
export const SCAN_RUN = SHADER_CONSTANTS.SCAN_WORKGROUP * SHADER_CONSTANTS.SCAN_ITEMS;
