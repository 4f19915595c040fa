import { CHUNK_SPLATS } from './constants.ts';
import { gpuStruct } from './gpu-struct.ts';
import type { ShaderStruct } from './structs.ts';

/**
 * A cell of a cloud's levels of detail: a chunk's splats with their merged splats (blobs), or sixteen
 * child cells. Indices run level by level; cells of chunks of splats come first.
 */
export const LevelCell = gpuStruct('LevelCell', {
  /** Bounds of the centres of all splats below it, about the cloud's origin. */
  minPosition: 'vec3f',
  /** Cell that has this cell's roots as its leaves; NO_CELL for the one at the top. */
  parent: 'u32',
  maxPosition: 'vec3f',
});

/** Range of a page's or a level's cells whose splats one dispatch merges. */
export const MergeParameters = gpuStruct('MergeParameters', {
  /** Index of the first cell of the dispatch, and of the one after its last. */
  firstCell: 'u32',
  endCell: 'u32',
  /** First cell of the page. */
  pageStart: 'u32',
  /** First cell of the level, of the next level, and of the first level above the chunks. */
  levelStart: 'u32',
  nextLevelStart: 'u32',
  upperStart: 'u32',
  /** Splats of the page; of upper levels, links tell. */
  splatCount: 'u32',
  /** 1 where a level is above: roots become its leaves. */
  hasNextLevel: 'u32',
  dispatchRow: 'u32',
});

/** Parameters of the LOD cut for one view: of a cloud, or of one of its instances. */
export const CutParameters = gpuStruct('CutParameters', {
  /** The camera in cloud space, about the cloud's origin. */
  camera: 'vec3f',
  /** A cell's squared threshold is its squared distance times this, … */
  squaredPerDistance: 'f32',
  /** … and at least this, in the cloud's units: that at the near plane, or of parallel rays. */
  leastSquared: 'f32',
  /** How far effects may move splats, in the cloud's units. */
  margin: 'f32',
  cellCount: 'u32',
  dispatchRow: 'u32',
});

/**
 * How far a frame's budget shifts the thresholds of its cuts: `shift` codes beyond SHIFT_NONE. Each
 * frame writes the first two fields. The others stay from frame to frame, 0 at first; where a frame
 * counts once (`countsInWindow`), it clears them.
 */
export const CutPlan = gpuStruct('CutPlan', {
  /** The first of the CUT_BINS shifts that a frame chooses from. */
  leastShift: 'u32',
  /** Most splats and blobs to draw, in all clouds with levels. */
  budget: 'u32',
  /** The first shift that is counted, unless it is less than the least. */
  base: 'u32',
  shift: 'u32',
  /** Of a frame's two counts: COUNT_ANEW before the first, COUNT_ALL or COUNT_NOTHING before the second. */
  next: 'u32',
});

/** Most cells whose leaves one dispatch of open-leaves opens. */
const OPENED_CELLS = 32;

/** Which leaves of cells above the chunks stand for cells that are not on the GPU. */
export const OpenedLeaves = gpuStruct('OpenedLeaves', {
  /** Of each of the sixteen cells below each cell: its error; 0 while it is not on the GPU. */
  errors: `array<vec4u, ${4 * OPENED_CELLS}>`,
  /** Per cell, the chunk of its leaves; chunks of blobs follow the chunks of splats, and are counted apart. */
  chunks: `array<vec4u, ${OPENED_CELLS / 4}>`,
  count: 'u32',
  /** See lib/dispatch.wgsl. */
  dispatchRow: 'u32',
});

const SHIFT_NONE = 4096;
/** Shifts that are counted, from one code to the next. */
const CUT_BINS = 1024;

/** Constants of stages that work on levels of detail. */
export const LEVEL_CONSTANTS = {
  /** Cells of a level in one of the level above. */
  CELL_CHILDREN: 16,
  /** Most roots of a cell. */
  CELL_ROOTS: 16,
  NO_CELL: 0xffffffff,
  OPENED_CELLS,
  /** Bits that an error loses in a link: see lib/level-link.wgsl. */
  ERROR_SHIFT: 19,
  /** Parent error of a node without a parent: no threshold reaches it. */
  ERROR_BOUNDLESS: 0xfff,
  /** Places to either side in which a node looks for one to merge with. */
  MERGED_RADIUS: 4,
  /** Shift of thresholds that leaves them as they are; 0 takes all to 0. */
  SHIFT_NONE,
  CUT_BINS,
  /**
   * The least shift of a budget. The shifts from here on reach from a 65,000th of the error that is
   * shifted to 65,000 times as much.
   */
  LEAST_SHIFT: SHIFT_NONE - CUT_BINS / 2,
  /**
   * The first count of a frame begins this many shifts below the last frame's. That is far enough if the
   * budget has grown by half, which is the most that a target in milliseconds lets it grow by.
   */
  SHIFT_MARGIN: 48,
  /** See `CutPlan.next`. */
  COUNT_ANEW: 0,
  COUNT_NOTHING: 1,
  COUNT_ALL: 2,
  /** Threads that find the shift. */
  PLAN_WORKGROUP: 256,
  /** Copies of the histogram for workgroups in turn: atomic additions to one word are serialised. */
  CUT_COPIES: 16,
  /** Most splats that may lie on top of each other in one blob. */
  MOST_OPACITY: 1000,
} as const;

/** A chunk of splats or blobs in its cell, with a link for each: how the merging stages leave it. */
export const ChunkLinks: ShaderStruct & { readonly words: number } = {
  name: 'ChunkLinks',
  /** 32-bit words of one. */
  words: 8 + CHUNK_SPLATS,
  wgsl: `struct ChunkLinks {
  cell: u32,
  /// Largest error of the cell's roots: the cell is drawn where that is more than its parent's threshold.
  cellError: u32,
  /// The chunk may draw something at thresholds from the one error up to the other.
  leastError: u32,
  largestParentError: u32,
  /// Largest standard deviation along any axis.
  largestScale: f32,
  /// Number of blobs, 0 for splats and leaves; and of these the first, each of which stands for two.
  count: u32,
  pairs: u32,
  /// Splats that budgets ignore: hidden ones, and ones without a parent, drawn at every threshold.
  uncounted: u32,
  /// See lib/level-link.wgsl; 0 for slots that hold nothing.
  links: array<u32, ${CHUNK_SPLATS}>,
}`,
};

/** Structs of the stages that know levels. */
export const LEVEL_STRUCTS: readonly ShaderStruct[] = [
  LevelCell,
  MergeParameters,
  CutParameters,
  CutPlan,
  OpenedLeaves,
  ChunkLinks,
];

/** Returns an error of thresholds, a length, after they were shifted; right to 2 %. */
export function shiftedError(error: number, shift: number): number {
  // Codes are of squares, sixteen to the octave.
  return error * 2 ** ((shift - LEVEL_CONSTANTS.SHIFT_NONE) / 32);
}
