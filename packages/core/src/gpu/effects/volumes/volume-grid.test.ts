import { expect, test } from 'vitest';
import { seededRandom } from '../../../testing/seeded-random.ts';
import { cellsAlong, gridOf, gridVectors, type VolumeReach } from './volume-grid.ts';

/** Returns the volumes that a grid names for a point, as volumes.wgsl finds them. */
function volumesAt(
  point: readonly number[],
  grid: readonly number[],
  cells: number,
  count: number,
): number[] {
  const place = point.map((value, axis) => Math.fround((value - grid[axis]) * grid[4 + axis]));
  const isInside = place.every((value) => value >= 0 && value <= cells);
  const [x, y, z] = place.map((value) => Math.floor(Math.min(Math.max(value, 0), cells - 1)));
  const cellWords = 4 * Math.ceil(count / 96);
  const first = 8 + cellWords * (isInside ? 1 + x + cells * (y + cells * z) : 0);
  return Array.from({ length: count }, (_, volume) => volume).filter(
    (volume) => Math.floor(grid[first + Math.floor(volume / 24)] / 2 ** (volume % 24)) % 2 === 1,
  );
}

function randomReaches(count: number, radius: number, unbounded: readonly number[] = []): VolumeReach[] {
  const random = seededRandom(count);
  return Array.from({ length: count }, (_, volume) => ({
    sphere: unbounded.includes(volume)
      ? null
      : { center: [random() * 2 - 1, random() * 3, 1e3 + random()], radius: radius * random() },
    slabs: volume % 2 === 0 ? [] : [{ factors: [random(), -random(), 3 * random(), -1e3], most: random() }],
  }));
}

/** Whether a volume may act on a point, but for rounding. */
function isWithin({ sphere, slabs }: VolumeReach, point: readonly number[]): boolean {
  const inSlabs = slabs.every(({ factors, most }) => {
    const sum = point.reduce((partial, value, axis) => partial + factors[axis] * value, factors[3]);
    return Math.abs(sum) <= 0.999 * most;
  });
  if (!sphere) return inSlabs;
  const away = Math.hypot(...point.map((value, axis) => value - sphere.center[axis]));
  return inSlabs && away <= 0.999 * sphere.radius;
}

const sizeOf = (count: number) => cellsAlong(count, 1 + 7 * count);

test('a grid names every volume that reaches a point, wherever that is', () => {
  for (const count of [3, 5, 24, 25, 64, 96, 97, 256]) {
    const reaches = randomReaches(count, 0.6, [2, count - 1]);
    const cells = sizeOf(count);
    const grid = gridOf(reaches, cells);
    expect(grid).toHaveLength(4 * gridVectors(count, cells));
    const random = seededRandom(7);
    const missed: string[] = [];
    for (let i = 0; i < 2000; i++) {
      // Some points lie on cells' borders, some outside of the grid.
      const point = [0, 1, 2].map((axis) => {
        const along = i % 3 === 0 ? Math.floor(random() * (cells + 1)) : (1.4 * random() - 0.2) * cells;
        return grid[axis] + along / grid[4 + axis];
      });
      const named = new Set(volumesAt(point, grid, cells, count));
      for (const [volume, reach] of reaches.entries()) {
        if (!named.has(volume) && isWithin(reach, point)) missed.push(`${volume} at ${point}`);
      }
    }
    expect(missed).toEqual([]);
  }
});

test('a point meets few of many small volumes', () => {
  const reaches = randomReaches(64, 0.1);
  const cells = sizeOf(64);
  expect(cells).toBe(8);
  const grid = gridOf(reaches, cells);
  const random = seededRandom(3);
  let met = 0;
  for (let i = 0; i < 1000; i++)
    met += volumesAt([random() * 2 - 1, random() * 3, 1e3 + random()], grid, cells, 64).length;
  expect(met / 1000).toBeLessThan(3);
});

test('few volumes have no grid, and volumes without a place or size have one', () => {
  expect(sizeOf(2)).toBe(0);
  expect(gridOf(randomReaches(2, 1), 0)).toEqual([]);
  for (const sphere of [null, { center: [3, 4, 5], radius: 0 }]) {
    const grid = gridOf(Array(5).fill({ sphere, slabs: [] }), 4);
    expect(grid.every(Number.isFinite)).toBe(true);
    expect(volumesAt([3, 4, 5], grid, 4, 5)).toEqual([0, 1, 2, 3, 4]);
  }
});

test('no list needs more room than 256 volumes without a grid', () => {
  for (let count = 1; count <= 256; count++) {
    const vectors = 1 + 7 * count + gridVectors(count, sizeOf(count));
    expect(vectors).toBeLessThanOrEqual(2048);
    expect(vectors).toBeLessThanOrEqual(2 * 2 ** Math.ceil(Math.log2(1 + 7 * count)));
  }
});
