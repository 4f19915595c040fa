export interface SortRoom {
  /** Number of keys that the buffers have room for. */
  readonly capacity: number;
  /** Number of keys that one workgroup takes. */
  readonly blockKeys: number;
}

/** Reference of plan-sort: the numbers of keys and of blocks. */
export function planSort(keyCount: number, { capacity, blockKeys }: SortRoom) {
  const sorted = Math.min(keyCount, capacity);
  return { keyCount: sorted, blockCount: Math.ceil(sorted / blockKeys) };
}
