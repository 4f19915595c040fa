import type { BrickCell } from '../../data/bricks/brick.ts';
import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { setLogScales } from '../../data/packing/chunks.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';

/**
 * Splats or blobs that approximate a whole streamed scene. They and their order do not depend on
 * the parts that are on the GPU. Unused slots between them are 0.
 */
export interface CoarseSplats {
  /** Unused slots included. */
  readonly count: number;
  readonly precision: GeometryPrecision;
  /** Packed geometry relative to the scene's origin; null if it is in the cloud's planes. */
  readonly words: Uint32Array | null;
  /**
   * Current position of the splats. The planes of a stream may change whenever this thread yields.
   */
  readonly spans: () => readonly SplatSpan[];
}

/** Successive splats of a plane, in whole chunks; the last chunk may be partial. */
export interface SplatSpan {
  /** Slot of the first splat in the plane, a multiple of 256. */
  readonly first: number;
  readonly count: number;
  /** Words of the `Chunk` structs of these splats. */
  readonly chunks: Float32Array;
}

/** Words of `Chunk` structs with the log scale ranges of `cells`, without bounds. */
export function chunksWithoutBounds(cells: readonly BrickCell[]): Float32Array<ArrayBuffer> {
  const chunks = new Float32Array(CHUNK_WORDS.count * cells.length);
  for (const [i, { logScales }] of cells.entries())
    setLogScales(chunks, i, { min: logScales[0], step: logScales[1] });
  return chunks;
}
