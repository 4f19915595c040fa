import type { Vec3 } from '../math/mat4.ts';
import type { Bounds } from '../packing/packed-cloud.ts';
import type { ShDegree } from '../splats/splat-set.ts';
import type { Brick } from './brick.ts';

/**
 * A scene in leaves: parts that are each kept at several levels of detail, of which one is to be
 * shown. All levels are splats, and lie in files that hold those of many leaves.
 */
export interface LeafScene {
  readonly name: string;
  /** Splats of the finest levels together, or more of them where that is not known. */
  readonly splatCount: number;
  readonly shDegree: ShDegree;
  /** Whether splats were trained with an antialias filter; absent if that is not known. */
  readonly isAntialiased?: boolean;
  /** Scene-space point that positions are relative to. */
  readonly origin: Vec3;
  /** Those that are known: more are found, and are at the end, once the one above them has been decoded. */
  readonly leaves: readonly SceneLeaf[];
  /** Most chunks of 256 splats that levels take together; undefined where leaves tell. */
  readonly mostChunks?: number;
  /** Bytes of files that have been fetched so far. */
  readonly fetchedBytes: number;
  /**
   * Fetches a file and decodes it, or takes it from among the last that were.
   *
   * @param onBytes receives how many bytes have been fetched since its last call.
   * @throws SplatFileError for a damaged one; SplatSourceError for a source that cannot be read;
   *   the signal's reason.
   */
  readonly read: (file: number, signal?: AbortSignal, onBytes?: (bytes: number) => void) => Promise<LeafFile>;
  /** Ends the workers that decode, and all reads. */
  readonly end: () => void;
}

export interface SceneLeaf {
  /**
   * Bounds of the splats of all levels, about the scene's origin; null where they are not known, and
   * then there is one level.
   */
  readonly bounds: Bounds | null;
  /** At least one; the finest first. */
  readonly levels: readonly LeafLevel[];
  /**
   * Number of the leaf, an earlier one, that this is a part of: the coarsest level of this one is in
   * the same file as the finest of that one, and shown only with it. Undefined for others.
   */
  readonly above?: number;
  /**
   * Of leaves that are worth the same, that of the lowest rank is refined first; above that of the
   * leaf above, and the same in whatever order leaves are found. By default its number.
   */
  readonly rank?: number;
}

/** One level of a leaf. */
export interface LeafLevel {
  /** Number of the file. */
  readonly file: number;
  /**
   * Splats, with those of the coarsest levels of the leaves that are a part of it; no more than
   * there are until the file has been decoded.
   */
  readonly count: number;
  /** Chunks of 256 that these take. */
  readonly chunkCount: number;
  /** How far it differs from the finest, as a length; never less than that of a finer level. */
  readonly error: number;
}

/** A decoded file. */
export interface LeafFile {
  /**
   * The splats of a level of a leaf of this scene, which lies in this file, in pieces of up to
   * sixteen cells, without those of leaves that are a part of it. Those that are not finite are left
   * out.
   *
   * @throws SplatFileError 'damaged' for splats outside of the leaf; DestroyedError after the end of the
   *   scene; WebSplatterError 'worker-failed'; the signal's reason.
   */
  pieces(leaf: SceneLeaf, level: LeafLevel, signal?: AbortSignal): Promise<SplatCells[]>;
}

/** Cells of splats, packed: those of each cell from a multiple of 256 on. */
export type SplatCells = Pick<Brick, 'cells' | 'geometry' | 'harmonics' | 'rows'>;

/** Stands for the row of a splat that a load of the finest levels alone does not have. */
export const NO_ROW = 0xffffffff;
