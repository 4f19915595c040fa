import type { FloaterFilter } from '../state/selecting.ts';
import { eachCenter, type ReadCloud, VALUES } from './scene-answers.ts';

/** A splat with fewer others than this within a radius is far from others. */
export const NEIGHBOURS = 8;
/** Splats between two reports of progress. */
const REPORTED_SPLATS = 1 << 16;
/** The cell of a splat and its neighbours. */
const STEPS = [0, -1, 1];

/** Tests splats by their index in their cloud. */
export type SplatTest = (cloud: ReadCloud, index: number) => boolean;

/**
 * Finds splats that are mostly mistakes of a training.
 *
 * @param limit scene units for `far` and `huge`, the opacity for `faint`, a ratio for `needle`.
 * @param onPart called with the fraction done, 0…1, while `far` compares all splats.
 */
export function floaterTest(
  clouds: readonly ReadCloud[],
  filter: FloaterFilter,
  limit: number,
  onPart: (part: number) => void = () => {},
): SplatTest {
  switch (filter) {
    case 'far':
      return farTest(clouds, limit, onPart);
    case 'huge': {
      const scales = new Map(clouds.map((cloud) => [cloud, scaleOf(cloud)]));
      return (cloud, i) => VALUES.longest(cloud.set, i) * scales.get(cloud)! >= limit;
    }
    case 'faint':
      return ({ set }, i) => VALUES.opacity(set, i) <= limit;
    case 'needle': {
      const leastLog = Math.log(limit);
      return ({ set: { logScales } }, i) => {
        const [x, y, z] = logScales.subarray(3 * i, 3 * i + 3);
        const longest = Math.max(x, y, z);
        // Discs are long along two axes.
        const middle = x + y + z - longest - Math.min(x, y, z);
        return longest - middle >= leastLog;
      };
    }
  }
}

/** Factor from a cloud's lengths to the scene's. */
function scaleOf({ modelMatrix: m }: ReadCloud): number {
  return m ? Math.hypot(m[0], m[1], m[2]) : 1;
}

function farTest(clouds: readonly ReadCloud[], radius: number, onPart: (part: number) => void): SplatTest {
  const places = placesOf(clouds);
  const isFar = farFlags(places, radius, onPart);
  let before = 0;
  const starts = new Map<ReadCloud, number>();
  for (const cloud of clouds) {
    starts.set(cloud, before);
    before += cloud.set.count;
  }
  return (cloud, i) => isFar[starts.get(cloud)! + i] === 1;
}

/** Centres of all clouds, x, y, z, in the scene's own space. */
function placesOf(clouds: readonly ReadCloud[]): Float64Array {
  const places = new Float64Array(3 * clouds.reduce((sum, { set }) => sum + set.count, 0));
  let next = 0;
  eachCenter(clouds, (center) => {
    places.set(center, next);
    next += 3;
  });
  return places;
}

/**
 * 1 for each place with fewer than `NEIGHBOURS` others within `radius`. Places are sorted into
 * cells as wide as the radius, so that only 27 of them are searched around each.
 */
function farFlags(places: Float64Array, radius: number, onPart: (part: number) => void): Uint8Array {
  const count = places.length / 3;
  const cells = Int32Array.from(places, (value) => Math.floor(value / radius));
  const { starts, members, bucketOf } = buckets(cells);
  const isFar = new Uint8Array(count);
  for (let i = 0; i < count; i++) {
    if (i % REPORTED_SPLATS === 0) onPart(i / count);
    isFar[i] = hasEnough(i) ? 0 : 1;
  }
  return isFar;

  function hasEnough(i: number): boolean {
    // The place finds itself, too.
    let missing = NEIGHBOURS + 1;
    for (const dz of STEPS)
      for (const dy of STEPS)
        for (const dx of STEPS) {
          missing -= countIn(i, cells[3 * i] + dx, cells[3 * i + 1] + dy, cells[3 * i + 2] + dz, missing);
          if (missing === 0) return true;
        }
    return false;
  }

  /** Number of places in a cell within the radius of place `i`, at most `most`. */
  function countIn(i: number, cellX: number, cellY: number, cellZ: number, most: number): number {
    let found = 0;
    const bucket = bucketOf(cellX, cellY, cellZ);
    for (let m = starts[bucket]; m < starts[bucket + 1] && found < most; m++) {
      const j = 3 * members[m];
      // Cells may share a bucket.
      if (cells[j] !== cellX || cells[j + 1] !== cellY || cells[j + 2] !== cellZ) continue;
      const [x, y, z] = [
        places[j] - places[3 * i],
        places[j + 1] - places[3 * i + 1],
        places[j + 2] - places[3 * i + 2],
      ];
      if (x * x + y * y + z * z <= radius * radius) found++;
    }
    return found;
  }
}

/** Indices of cells by a hash: members of bucket b are at `starts[b]` up to `starts[b + 1]`. */
function buckets(cells: Int32Array) {
  const count = cells.length / 3;
  const size = 2 ** Math.ceil(Math.log2(count + 1));
  const bucketOf = (x: number, y: number, z: number) =>
    (Math.imul(x, 73_856_093) ^ Math.imul(y, 19_349_663) ^ Math.imul(z, 83_492_791)) & (size - 1);
  const bucketAt = (i: number) => bucketOf(cells[3 * i], cells[3 * i + 1], cells[3 * i + 2]);
  const starts = new Uint32Array(size + 1);
  for (let i = 0; i < count; i++) starts[bucketAt(i) + 1]++;
  for (let b = 0; b < size; b++) starts[b + 1] += starts[b];
  const members = new Uint32Array(count);
  const next = starts.slice();
  for (let i = 0; i < count; i++) members[next[bucketAt(i)]++] = i;
  return { starts, members, bucketOf };
}
