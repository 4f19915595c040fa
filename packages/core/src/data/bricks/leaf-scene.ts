import type { Vec3 } from '../math/mat4.ts';
import type { Bounds } from '../packing/packed-cloud.ts';
import type { ShDegree } from '../splats/splat-set.ts';
import type { Brick } from './brick.ts';

/**
 * A scene in leaves, each of which has several levels of detail and is drawn at one of them. All
 * levels are splats. A file holds levels of many leaves.
 */
export interface LeafScene {
  readonly name: string;
  /** Splats of the finest levels of all leaves; an upper bound if the exact number is unknown. */
  readonly splatCount: number;
  readonly shDegree: ShDegree;
  /** Whether splats were trained with an antialias filter; absent if that is not known. */
  readonly isAntialiased?: boolean;
  /** Scene-space point that positions are relative to. */
  readonly origin: Vec3;
  /** The leaves found so far. Decoding a leaf's parent may append its children. */
  readonly leaves: readonly SceneLeaf[];
  /** Most chunks of 256 splats that a choice of levels takes; undefined if `leaves` is complete. */
  readonly mostChunks?: number;
  /** Bytes of files that have been fetched so far. */
  readonly fetchedBytes: number;
  /** Bytes of fetched files that are kept, so that they need not be fetched again. */
  readonly keptBytes: number;
  /**
   * Fetches a file, or returns it from a cache of the last files.
   *
   * @param onBytes receives the number of bytes fetched since its last call.
   * @throws SplatFileError for a damaged file; SplatSourceError for a source that cannot be read;
   *   the signal's reason.
   */
  readonly read: (file: number, signal?: AbortSignal, onBytes?: (bytes: number) => void) => Promise<LeafFile>;
  /** Ends the workers that decode, and all reads. */
  readonly end: () => void;
}

export interface SceneLeaf {
  /**
   * Bounds of the splats of all levels, relative to the scene's origin. Null if they are unknown: the
   * leaf then has one level.
   */
  readonly bounds: Bounds | null;
  /** At least one level; the finest is first. */
  readonly levels: readonly LeafLevel[];
  /**
   * Index of the parent leaf, which precedes this one; undefined for a root. This leaf's coarsest level
   * lies in the file of the parent's finest level, and is drawn only with it.
   */
  readonly above?: number;
  /**
   * Tie-breaker for refinement: of leaves with equal priority, the one with the lowest rank is refined
   * first. Larger than the parent's rank, and independent of the order in which leaves are found.
   * Default: the leaf's index.
   */
  readonly rank?: number;
}

/** One level of a leaf. */
export interface LeafLevel {
  /** Index of the file. */
  readonly file: number;
  /**
   * Splats of the level, including the coarsest levels of child leaves. An upper bound until the file
   * has been decoded.
   */
  readonly count: number;
  /** Chunks of 256 splats that `count` splats take. */
  readonly chunkCount: number;
  /** Distance from the finest level, in scene units; no less than the error of any finer level. */
  readonly error: number;
}

/** One level of a leaf. */
export interface LeafPart {
  readonly leaf: SceneLeaf;
  readonly level: LeafLevel;
}

/** A fetched file. */
export interface LeafFile {
  /**
   * Splats of levels of leaves, which must lie in this file: of each in pieces of up to sixteen
   * cells. Splats of child leaves and splats that are not finite are left out. Many small leaves are
   * packed sooner together.
   *
   * @throws SplatFileError 'damaged' for splats outside of a leaf; DestroyedError once the scene has
   *   ended; WebSplatterError 'worker-failed'; the signal's reason.
   */
  pack(parts: readonly LeafPart[], signal?: AbortSignal): Promise<SplatCells[][]>;
}

/** Packed splats in cells. The splats of each cell begin at a multiple of 256. */
export type SplatCells = Pick<Brick, 'cells' | 'geometry' | 'harmonics' | 'fileIndices'>;

/** Row of a splat that has none, because a load of the finest levels alone does not contain it. */
export const NO_ROW = 0xffffffff;
