/** Bits of a key that a pass of a radix sort reads, and number of keys that a workgroup takes. */
export interface SortPass {
  readonly digitShift: number;
  readonly digitBits: number;
  readonly blockKeys: number;
}

export function digitOf(key: number, { digitShift, digitBits }: SortPass): number {
  // Shader and reference agree beyond the key's top too: extractBits takes only existing bits.
  return (key >>> digitShift) & ((1 << digitBits) - 1);
}

/** Reference of sort-histogram: counts by digit and block; all blocks of digit 0, then 1, … */
export function sortHistogram(keys: ArrayLike<number>, pass: SortPass): Uint32Array {
  const blockCount = Math.ceil(keys.length / pass.blockKeys);
  const counts = new Uint32Array(blockCount << pass.digitBits);
  for (let i = 0; i < keys.length; i++) {
    counts[digitOf(keys[i], pass) * blockCount + Math.floor(i / pass.blockKeys)]++;
  }
  return counts;
}
