/**
 * Words of a `Chunk` struct, for readers and writers on the CPU: the load worker is spared the code
 * that lays structs out. A test holds them against `Chunk`.
 */
export const CHUNK_WORDS = {
  minPosition: 0,
  minLogScale: 3,
  maxPosition: 4,
  logScaleStep: 7,
  count: 8,
} as const;
