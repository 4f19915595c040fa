// A grid over the volumes of a cloud. Each of its cells has a block of words with a bit for each volume that may act in
// the cell, so that a splat tests few of many volumes. The first block is for all places outside of the grid.
// `volumes.wgsl` reads it.

/**
 * Volumes per word of a block: float32 holds so many bits exactly. Shaders read words as numbers, because
 * devices may flush small floats with other bits to 0.
 */
const WORD_BITS = 24;
const VECTOR_BITS = 4 * WORD_BITS;
/** Below this many, testing each volume is as quick as finding those of a cell. */
const FEWEST_VOLUMES = 3;
/** More cells along an axis would save little. */
const MOST_CELLS = 8;
/** Most vec4f of a list and its grid: 256 volumes alone take 1 + 7 · 256, in buffers of a power of two. */
const MOST_VECTORS = 2048;
/** vec4f in front of the blocks: the grid's first corner, and its cells per unit. */
const GRID_VECTORS = 2;
/** Cells reach this part of their size into their neighbours: shaders round. */
const OVERLAP = 1e-3;

/** Where in its cloud's space a volume may act on splats: within all of these. */
export interface VolumeReach {
  /** A sphere around all of it; null if it has no bounds. */
  readonly sphere: { readonly center: ArrayLike<number>; readonly radius: number } | null;
  readonly slabs: readonly Slab[];
}

/** The part of space where the sum of x, y, z and 1, times these factors, is from −`most` to `most`. */
export interface Slab {
  readonly factors: ArrayLike<number>;
  readonly most: number;
}

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
  const spheres = reaches.flatMap(({ sphere }) => sphere ?? []);
  const extents = [0, 1, 2].map((axis): Extent => {
    const first = Math.min(...spheres.map(({ center, radius }) => center[axis] - radius));
    const last = Math.max(...spheres.map(({ center, radius }) => center[axis] + radius));
    // A grid of a point, or of nothing, still has a size.
    return { first: Number.isFinite(first) ? first : 0, size: last > first ? (last - first) / cells : 1 };
  });
  const words = new Float64Array(cellWords * (cells ** 3 + 1));
  for (const [volume, { sphere, slabs }] of reaches.entries()) {
    const word = Math.floor(volume / WORD_BITS);
    const bit = 2 ** (volume % WORD_BITS);
    if (!sphere) words[word] += bit;
    const squares = extents.map((extent, axis) => squaredDistances(sphere, extent, axis, cells));
    const tests = slabs.map((slab) => slabInCells(slab, extents));
    const squaredRadius = sphere ? sphere.radius ** 2 : 0;
    // The first block is not a cell's.
    let at = word;
    for (let z = 0; z < cells; z++)
      for (let y = 0; y < cells; y++)
        for (let x = 0; x < cells; x++) {
          at += cellWords;
          if (squares[0][x] + squares[1][y] + squares[2][z] > squaredRadius) continue;
          const isMet = tests.every(
            ({ step, offset, most }) => Math.abs(offset + step[0] * x + step[1] * y + step[2] * z) <= most,
          );
          if (isMet) words[at] += bit;
        }
  }
  return [...extents.map(({ first }) => first), 0, ...extents.map(({ size }) => 1 / size), 0, ...words];
}

/** The cells along an axis: where the first begins, and the size of each. */
interface Extent {
  readonly first: number;
  readonly size: number;
}

/** Returns the squared distance of each cell along an axis from a sphere's middle; 0 without a sphere. */
function squaredDistances(
  sphere: VolumeReach['sphere'],
  { first, size }: Extent,
  axis: number,
  cells: number,
): number[] {
  return Array.from({ length: cells }, (_, cell) => {
    if (!sphere) return 0;
    const place = (sphere.center[axis] - first) / size;
    return (Math.max(cell - OVERLAP - place, place - (cell + 1 + OVERLAP), 0) * size) ** 2;
  });
}

/** The slab in units of cells: cell (x, y, z) may meet it if |offset + step · (x, y, z)| ≤ most. */
function slabInCells({ factors, most }: Slab, extents: readonly Extent[]) {
  const step = extents.map(({ size }, axis) => factors[axis] * size);
  const atFirst = extents.reduce((sum, { first }, axis) => sum + factors[axis] * first, factors[3]);
  const room = step.reduce((sum, length) => sum + (0.5 + OVERLAP) * Math.abs(length), 0);
  const offset = atFirst + 0.5 * (step[0] + step[1] + step[2]);
  return { step, offset, most: most + room };
}
