import type { Vec3 } from '../math/mat4.ts';
import type { Bounds } from '../packing/packed-cloud.ts';
import type { ShDegree } from '../splats/splat-set.ts';

/**
 * Scenes of any size are kept in bricks, which are fetched by themselves. A brick is all cells
 * below one cell of a cloud's levels: up to sixteen, each with up to 256 leaves. On the lowest level
 * leaves are splats, on others the blobs that stand for a cell of the level below. Blobs between
 * the leaves of a cell and its sixteen roots are stored nowhere: the GPU makes them when a brick
 * arrives.
 */
export interface Brick {
  /** 0: leaves are splats. */
  readonly level: number;
  /** One to sixteen, in Morton order. */
  readonly cells: readonly BrickCell[];
  /**
   * 256 leaves per cell, as on the GPU: `packed` on level 0, else `f32` with the two sums of a blob
   * in its empty words. Zero behind the last leaf of a cell.
   */
  readonly geometry: Uint32Array<ArrayBuffer>;
  /** u8 harmonics of the same leaves; empty at degree 0. */
  readonly harmonics: Uint32Array<ArrayBuffer>;
  /** Row of each leaf in the files that the scene was made of; empty above level 0. */
  readonly fileIndices: Uint32Array<ArrayBuffer>;
}

export interface BrickCell {
  /** Of the centres of all splats below it, about the scene's origin. */
  readonly bounds: Bounds;
  /** The largest standard deviation, along any axis, of all splats below it. */
  readonly largestScale: number;
  /** Leaf `i` is in place `i`; above level 0, root `r` of child cell `k` in place `16 k + r`. */
  readonly leafCount: number;
  /** Range of the packed log scales of its leaves: least, and step; 0 above level 0. */
  readonly logScales: readonly [least: number, step: number];
  /** The brick with the cells below; null on level 0. */
  readonly child: BrickAddress | null;
  /**
   * Of each cell below: its error, 1 to 4094, as in links (see shaders/lib/level-link.wgsl). Above
   * level 0 only. It is never less than the errors of that cell's own children.
   */
  readonly childErrors: readonly number[];
  /** Of each cell below: how many roots it has, 1 to 16. Above level 0 only. */
  readonly childRoots: readonly number[];
}

/** Where a brick lies in its file. */
export interface BrickAddress {
  /** Bricks are numbered from the root on, level by level and in Morton order. */
  readonly number: number;
  readonly offset: number;
  readonly bytes: number;
}

/** A scene in bricks. */
export interface BrickScene {
  readonly name: string;
  readonly splatCount: number;
  readonly brickCount: number;
  readonly shDegree: ShDegree;
  /** Whether splats were trained with an antialias filter; absent if that is not known. */
  readonly isAntialiased?: boolean;
  /** Scene-space point that positions are relative to. */
  readonly origin: Vec3;
  /** Scene space. */
  readonly bounds: Bounds;
  readonly robustBounds: Bounds;
  /** The brick with the one cell at the top. */
  readonly root: BrickAddress;
  /**
   * Fetches a brick.
   *
   * @throws SplatFileError for a damaged one; SplatSourceError for a source that cannot be read or
   *   has changed; WebSplatterError 'worker-failed' if the worker that decodes it dies;
   *   DestroyedError after `end`; the signal's reason.
   */
  readonly read: (address: BrickAddress, signal?: AbortSignal) => Promise<Brick>;
  /** Ends the workers that read and rejects pending reads. Call it once no more bricks are needed. */
  readonly end: () => void;
}
