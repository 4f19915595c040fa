/**
 * Volumes per word of a cell: float32 holds so many bits exactly. Shaders read words as numbers, because
 * devices may flush small floats with other bits to 0.
 */
const WORD_BITS = 24;
const VECTOR_BITS = 4 * WORD_BITS;
/** Below this many, testing each volume is as quick as finding those of a cell. */
const FEWEST_VOLUMES = 5;
/** More cells along an axis would save little. */
const MOST_CELLS = 8;
/** Most vec4f of a list with a grid: as many as 256 volumes take with the room of a power of two. */
const MOST_VECTORS = 2048;
/** Where the cells begin: the grid's first corner, and its cells per unit. */
const GRID_VECTORS = 2;
/** Cells reach this part of their size into their neighbours: shaders round. */
const OVERLAP = 1e-3;

/** The part of a cloud's space that a volume may act on: a sphere, or everything if null. */
export type VolumeReach = { readonly center: ArrayLike<number>; readonly radius: number } | null;

/**
 * Returns how many cells the grid of a list of volumes has along each axis; 0 without a grid.
 *
 * @param listVectors vec4f of the list without the grid.
 */
export function cellsAlong(volumeCount: number, listVectors: number): number {
  if (volumeCount < FEWEST_VOLUMES) return 0;
  const room = Math.min(MOST_VECTORS, 2 * 2 ** Math.ceil(Math.log2(listVectors)));
  let cells = MOST_CELLS;
  while (cells > 1 && listVectors + gridVectors(volumeCount, cells) > room) cells--;
  return cells;
}

/** Returns the number of vec4f of a grid. */
export function gridVectors(volumeCount: number, cells: number): number {
  return cells === 0 ? 0 : GRID_VECTORS + (cells ** 3 + 1) * Math.ceil(volumeCount / VECTOR_BITS);
}

/**
 * Returns the numbers of a grid over all volumes with bounds, as volumes.wgsl takes them: its first
 * corner, cells per unit, and the volumes that may act outside of the grid, then in each cell, x first.
 */
export function gridOf(reaches: readonly VolumeReach[], cells: number): number[] {
  if (cells === 0) return [];
  const cellWords = 4 * Math.ceil(reaches.length / VECTOR_BITS);
  const bounded = reaches.filter((reach) => reach !== null);
  const extents = [0, 1, 2].map((axis) => {
    const first = Math.min(...bounded.map(({ center, radius }) => center[axis] - radius));
    const last = Math.max(...bounded.map(({ center, radius }) => center[axis] + radius));
    // A grid of a point, or of nothing, still has a size.
    const size = last > first ? (last - first) / cells : 1;
    return { first: Number.isFinite(first) ? first : 0, size };
  });
  const words = new Float64Array(cellWords * (cells ** 3 + 1));
  const add = (cell: number, volume: number) => {
    words[cellWords * cell + Math.floor(volume / WORD_BITS)] += 2 ** (volume % WORD_BITS);
  };
  for (const [volume, reach] of reaches.entries()) {
    if (!reach) {
      for (let cell = 0; cell <= cells ** 3; cell++) add(cell, volume);
      continue;
    }
    const along = extents.map(({ first, size }, axis) => {
      const start = (reach.center[axis] - first) / size;
      // The distance of each cell from the sphere's middle, in its units.
      return Array.from({ length: cells }, (_, cell) => {
        const beyond = Math.max(cell - OVERLAP - start, start - (cell + 1 + OVERLAP), 0) * size;
        return beyond * beyond;
      });
    });
    for (let z = 0; z < cells; z++)
      for (let y = 0; y < cells; y++) {
        const away = along[1][y] + along[2][z];
        if (away > reach.radius ** 2) continue;
        for (let x = 0; x < cells; x++)
          if (along[0][x] + away <= reach.radius ** 2) add(1 + x + cells * (y + cells * z), volume);
      }
  }
  return [...extents.map(({ first }) => first), 0, ...extents.map(({ size }) => 1 / size), 0, ...words];
}
