/**
 * Words of a `Chunk` struct, for what reads and writes chunks on the CPU: the load worker is spared the code that lays structs out.
 * A test holds them against `Chunk`.
 */
export const CHUNK_WORDS = { minPosition: 0, maxScale: 3, maxPosition: 4, count: 8 } as const;
