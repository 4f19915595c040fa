/** Reference of ingest-gather over all pages: word `word` of the splats of `list`, with the bits of `mask`. */
export function ingestGather(
  plane: Uint32Array,
  wordsPerSplat: number,
  word: number,
  list: Uint32Array,
  mask = 0xffffffff,
): Uint32Array {
  return list.map((splat) => plane[splat * wordsPerSplat + word] & mask);
}
