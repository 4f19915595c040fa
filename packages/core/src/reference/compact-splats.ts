import { CHUNK_SPLATS, SHADER_CONSTANTS } from '../data/layout/constants.ts';

/**
 * Reference of compact-splats: numbers of the visible splats in storage order, counted through all
 * chunks of the frame.
 *
 * @param visibleChunks chunk of each slot, ascending.
 * @param visibilityMasks MASK_WORDS words per slot, one bit per splat.
 * @param visibleCapacity most splats to list.
 */
export function compactSplats(
  visibleChunks: ArrayLike<number>,
  visibilityMasks: ArrayLike<number>,
  visibleCapacity: number,
): number[] {
  const visibleSplats: number[] = [];
  for (let slot = 0; slot < visibleChunks.length; slot++) {
    for (let lane = 0; lane < CHUNK_SPLATS; lane++) {
      const word = visibilityMasks[slot * SHADER_CONSTANTS.MASK_WORDS + (lane >> 5)];
      if ((word >>> (lane & 31)) & 1) visibleSplats.push(visibleChunks[slot] * CHUNK_SPLATS + lane);
    }
  }
  return visibleSplats.slice(0, visibleCapacity);
}
