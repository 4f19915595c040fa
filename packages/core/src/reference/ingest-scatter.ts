/**
 * Reference of ingest-scatter: `plane` with `words` as the `count` words from `word` on of its
 * splats.
 */
export function ingestScatter(
  plane: Uint32Array,
  wordsPerSplat: number,
  word: number,
  count: number,
  words: Uint32Array,
): Uint32Array {
  return plane.map((value, i) => {
    const place = (i % wordsPerSplat) - word;
    return place >= 0 && place < count ? words[count * Math.floor(i / wordsPerSplat) + place] : value;
  });
}
