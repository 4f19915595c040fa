import { type Harmonics, isPacked, isPalette } from '../../../data/packing/harmonics.ts';
import { mapColumns } from '../../../data/splats/columns.ts';
import { coefficientsPerSplat, type SplatSet } from '../../../data/splats/splat-set.ts';

/** A copy of a range of a set's splats. */
export function sliceOf(set: SplatSet<Harmonics>, from: number, to: number): SplatSet<Harmonics> {
  const { harmonics } = set;
  return {
    ...set,
    ...mapColumns(set, (column, width) => column.slice(width * from, width * to) as typeof column),
    count: to - from,
    harmonics: harmonicsBetween(harmonics, from, to),
    fileIndices: new Uint32Array(to - from),
    dropped: {},
  };
}

function harmonicsBetween(harmonics: Harmonics, from: number, to: number): Harmonics {
  if (isPacked(harmonics)) {
    const { words, wordsPerSplat } = harmonics;
    return { ...harmonics, words: words.slice(wordsPerSplat * from, wordsPerSplat * to) };
  }
  if (isPalette(harmonics))
    return {
      ...harmonics,
      entries: harmonics.entries.slice(),
      indices: harmonics.indices.slice(from, to),
    };
  const width = coefficientsPerSplat(harmonics.degree);
  return { ...harmonics, coefficients: harmonics.coefficients.slice(width * from, width * to) };
}
