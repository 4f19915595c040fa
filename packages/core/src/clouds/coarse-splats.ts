import type { BrickCell } from '../data/bricks/brick.ts';
import { CHUNK_WORDS } from '../data/layout/chunk-words.ts';
import { setLogScales } from '../data/packing/chunks.ts';
import type { GeometryPrecision } from '../data/packing/precision.ts';

/**
 * Splats, or blobs that stand for them, that show all of a streamed scene coarsely: the same ones in
 * the same order, however much of the scene is on the GPU. Places between them are 0.
 */
export interface CoarseSplats {
  /** With the places between them. */
  readonly count: number;
  readonly precision: GeometryPrecision;
  /** Their geometry, about the scene's origin; null: it is in the planes of the cloud. */
  readonly words: Uint32Array | null;
  /** Where they lie now: the planes of a stream may change between two turns of the thread. */
  readonly spans: () => readonly SplatSpan[];
}

/** Successive splats of a plane, whole chunks but perhaps the last. */
export interface SplatSpan {
  /** Place of the first in the plane, a multiple of 256. */
  readonly first: number;
  readonly count: number;
  /** Words of the `Chunk` structs of these splats. */
  readonly chunks: Float32Array;
}

/** Words of `Chunk` structs that have the ranges of log scales of cells, and no bounds. */
export function chunksWithoutBounds(cells: readonly BrickCell[]): Float32Array<ArrayBuffer> {
  const chunks = new Float32Array(CHUNK_WORDS.count * cells.length);
  for (const [i, { logScales }] of cells.entries())
    setLogScales(chunks, i, { min: logScales[0], step: logScales[1] });
  return chunks;
}
