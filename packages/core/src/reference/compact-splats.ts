import { CHUNK_SPLATS, SHADER_CONSTANTS } from '../layout/constants.ts';

/**
 * Twin of the GPU's compact-splats: numbers of the splats to draw, in storage order, counting through all chunks.
 *
 * @param visibleChunks chunk of each slot, ascending.
 * @param visibilityMasks MASK_WORDS words per slot, a bit per splat.
 */
export function compactSplats(
  visibleChunks: ArrayLike<number>,
  visibilityMasks: ArrayLike<number>,
): number[] {
  const visibleSplats: number[] = [];
  for (let slot = 0; slot < visibleChunks.length; slot++) {
    for (let lane = 0; lane < CHUNK_SPLATS; lane++) {
      const word = visibilityMasks[slot * SHADER_CONSTANTS.MASK_WORDS + (lane >> 5)];
      if ((word >>> (lane & 31)) & 1) visibleSplats.push(visibleChunks[slot] * CHUNK_SPLATS + lane);
    }
  }
  return visibleSplats;
}
