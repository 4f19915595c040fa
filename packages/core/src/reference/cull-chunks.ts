import type { FrustumSide } from '../data/camera/frustum.ts';

/** Bounds of a chunk of splats, about its cloud's origin. */
export interface ChunkBounds {
  /** Bounds of the centres. */
  readonly minPosition: ArrayLike<number>;
  readonly maxPosition: ArrayLike<number>;
  /** Largest standard deviation along any axis. */
  readonly maxScale: number;
}

/** Reference of cull-chunks: whether the chunk can reach into the image. */
export function isChunkInFrustum(chunk: ChunkBounds, planes: readonly FrustumSide[]): boolean {
  return chunkClearance(chunk, planes) >= 0;
}

/**
 * Clearance of the chunk from the side of the frustum that it is least inside of, relative to the
 * sum of the magnitudes of all terms of that side's test; negative outside. In float32 the sign is
 * certain only away from 0.
 */
export function chunkClearance(
  { minPosition, maxPosition, maxScale }: ChunkBounds,
  planes: readonly FrustumSide[],
): number {
  let clearance = Number.POSITIVE_INFINITY;
  for (const { normal, offset, reach } of planes) {
    let best = offset + reach * maxScale;
    let magnitude = Math.abs(offset) + reach * maxScale;
    for (let axis = 0; axis < 3; axis++) {
      const atMin = normal[axis] * minPosition[axis];
      const atMax = normal[axis] * maxPosition[axis];
      best += Math.max(atMin, atMax);
      magnitude += Math.abs(atMin) + Math.abs(atMax);
    }
    if (magnitude > 0) clearance = Math.min(clearance, best / magnitude);
  }
  return clearance;
}
