/** Reference of ingest-scatter: `plane` with `words` as word `word` of its splats. */
export function ingestScatter(
  plane: Uint32Array,
  wordsPerSplat: number,
  word: number,
  words: Uint32Array,
): Uint32Array {
  return plane.map((value, i) => (i % wordsPerSplat === word ? words[Math.floor(i / wordsPerSplat)] : value));
}
