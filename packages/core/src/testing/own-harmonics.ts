import type { Harmonics, PackedHarmonics } from '../data/packing/harmonics.ts';

/** Packed harmonics of which each splat has its own. Throws for others. */
export function ownHarmonics(harmonics: Harmonics): PackedHarmonics {
  if ('wordsPerSplat' in harmonics) return harmonics;
  throw new Error('The harmonics are not of each splat.');
}
