export interface SortRoom {
  /** Number of keys that the buffers have room for. */
  readonly capacity: number;
  /** Number of keys that one workgroup takes. */
  readonly tileKeys: number;
  readonly digitBits: number;
}

/** Twin of plan-sort: the numbers of keys, of tiles and of digit counts. */
export function planSort(keyCount: number, { capacity, tileKeys, digitBits }: SortRoom) {
  const sorted = Math.min(keyCount, capacity);
  const tileCount = Math.ceil(sorted / tileKeys);
  return { keyCount: sorted, tileCount, digitCountCount: tileCount * 2 ** digitBits };
}
