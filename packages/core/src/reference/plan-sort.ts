export interface SortRoom {
  /** Keys that the buffers have room for. */
  readonly capacity: number;
  /** Keys that one workgroup takes. */
  readonly tileKeys: number;
  readonly digitBits: number;
}

/** Twin of the GPU's plan-sort: how many keys are sorted, in how many tiles, and with how many counts of digits. */
export function planSort(keyCount: number, { capacity, tileKeys, digitBits }: SortRoom) {
  const sorted = Math.min(keyCount, capacity);
  const tileCount = Math.ceil(sorted / tileKeys);
  return { keyCount: sorted, tileCount, digitCountCount: tileCount * 2 ** digitBits };
}
