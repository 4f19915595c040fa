/** Division of keys into digits and tiles. */
export interface SortShape {
  /** Bits per pass. */
  readonly digitBits: number;
  readonly passes: number;
  /** Threads per workgroup. */
  readonly workgroup: number;
  /** Keys per thread; a tile has workgroup · itemsPerThread keys. */
  readonly itemsPerThread: number;
}

/** Returns the shape as constants for the sort's shaders. */
export function sortConstants({ digitBits, workgroup, itemsPerThread }: SortShape) {
  return {
    DIGIT_BITS: digitBits,
    SORT_WORKGROUP: workgroup,
    SORT_ITEMS: itemsPerThread,
    SORT_TILE: tileKeysOf({ workgroup, itemsPerThread }),
  };
}

/** Number of keys per tile: one workgroup of a pass takes one tile. */
export function tileKeysOf({
  workgroup,
  itemsPerThread,
}: Pick<SortShape, 'workgroup' | 'itemsPerThread'>): number {
  return workgroup * itemsPerThread;
}

/**
 * Chooses the shape with the fewest passes for keys below 2^keyBits. Masks of the scatter pass take 2^digitBits bits per
 * thread, so longer digits go with fewer threads to stay within WebGPU's 16 KiB of workgroup memory.
 */
export function sortShapeFor(keyBits: number): SortShape {
  if (keyBits <= 24)
    return { digitBits: 8, passes: Math.max(1, Math.ceil(keyBits / 8)), workgroup: 256, itemsPerThread: 8 };
  if (keyBits <= 27) return { digitBits: 9, passes: 3, workgroup: 128, itemsPerThread: 16 };
  return { digitBits: 8, passes: 4, workgroup: 256, itemsPerThread: 8 };
}
