/**
 * Reference of ingest-gather over all pages: `words` words from `word` on of the splats of `list`,
 * the last with the bits of `mask`.
 */
export function ingestGather(
  plane: Uint32Array,
  wordsPerSplat: number,
  word: number,
  words: number,
  list: Uint32Array,
  mask = 0xffffffff,
): Uint32Array {
  return Uint32Array.from({ length: words * list.length }, (_, i) => {
    const value = plane[list[Math.floor(i / words)] * wordsPerSplat + word + (i % words)];
    return i % words === words - 1 ? value & mask : value;
  });
}
