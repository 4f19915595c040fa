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
  /** Splats of the finest levels together. */
  readonly splatCount: number;
  readonly shDegree: ShDegree;
  /** Whether splats were trained with an antialias filter; absent if that is not known. */
  readonly isAntialiased?: boolean;
  /** Scene-space point that positions are relative to. */
  readonly origin: Vec3;
  readonly leaves: readonly SceneLeaf[];
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
}

export interface SceneLeaf {
  /** Of all splats of all levels; null where that is not known, and then there is one level. */
  readonly bounds: Bounds | null;
  /** At least one; the finest first. */
  readonly levels: readonly LeafLevel[];
}

/** One level of a leaf: splats of a file, one after another. */
export interface LeafLevel {
  /** Number of the file. */
  readonly file: number;
  readonly offset: number;
  readonly count: number;
  /** Row of the first one in a load of the finest levels alone; null where it is not among these. */
  readonly firstRow: number | null;
  /** How far it differs from the finest, as a length; never less than that of a finer level. */
  readonly error: number;
}

/** A decoded file. */
export interface LeafFile {
  /**
   * The splats of a level of a leaf, which lies in this file, in pieces of up to sixteen cells.
   * Those that are not finite are left out.
   *
   * @throws SplatFileError 'damaged' for splats outside of the leaf; the signal's reason.
   */
  readonly pieces: (leaf: SceneLeaf, level: LeafLevel, signal?: AbortSignal) => Promise<SplatCells[]>;
}

/** Cells of splats, packed: those of each cell from a multiple of 256 on. */
export type SplatCells = Pick<Brick, 'cells' | 'geometry' | 'harmonics' | 'rows'>;

/** Stands for the row of a splat that a load of the finest levels alone does not have. */
export const NO_ROW = 0xffffffff;
