import { describe, expect, test } from 'vitest';
import { Chunk } from '../layout/structs.ts';
import { mortonOrder, permuteSplats } from '../packing/morton-order.ts';
import { type PackedCloud, packCloud } from '../packing/packed-cloud.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import { randomSplats, type SplatValues, splatsOf } from '../testing/random-splats.ts';
import { seededRandom } from '../testing/seeded-random.ts';
import { chunkTree, raycastCloud } from './raycast-cloud.ts';

const pack = (set: SplatSet) => packCloud(set, { geometryPrecision: 'packed' });
const packOf = (splats: readonly SplatValues[]) => pack(splatsOf(splats));

/** The chunks that six million splats on a sphere of radius 1 would have, without the splats. */
function sphereOfChunks(chunkCount: number): PackedCloud {
  const random = seededRandom(9);
  const centers = splatsOf(
    Array.from({ length: chunkCount }, () => {
      const z = 2 * random() - 1;
      const angle = 2 * Math.PI * random();
      const radius = Math.sqrt(1 - z * z);
      return { position: [radius * Math.cos(angle), radius * Math.sin(angle), z] };
    }),
  );
  const { positions } = permuteSplats(centers, mortonOrder(centers.positions, chunkCount));
  const chunks = new ArrayBuffer(Chunk.bytes * chunkCount);
  for (let chunk = 0; chunk < chunkCount; chunk++) {
    const center = Array.from(positions.subarray(3 * chunk, 3 * chunk + 3));
    const bounds = {
      minPosition: center.map((c) => c - 0.02),
      maxPosition: center.map((c) => c + 0.02),
    };
    Chunk.write(chunks, { ...bounds, maxScale: 0.001, padding: 0 }, chunk * Chunk.bytes);
  }
  const bounds = { min: [-1, -1, -1], max: [1, 1, 1] } as const;
  return { ...packOf([]), count: 256 * chunkCount, chunks, bounds, robustBounds: bounds };
}

describe('raycastCloud', () => {
  test('meets the bounds of one chunk, widened by a standard deviation, about the origin of the cloud', () => {
    const scale = Math.log(0.25);
    const cloud = pack({
      ...splatsOf([
        { position: [0, 0, 0], logScales: [scale, -9, -9] },
        { position: [1, 2, 3], logScales: [-9, -9, -9] },
      ]),
      origin: [6.4e6, 0, 0],
    });
    const hit = raycastCloud(cloud, [6.4e6 + 0.5, 1, 10], [0, 0, -2]);
    expect(hit?.distance).toBeCloseTo((10 - 3.25) / 2, 3);
    expect(hit?.point[0]).toBe(6.4e6 + 0.5);
    expect(hit?.point[1]).toBe(1);
    expect(hit?.point[2]).toBeCloseTo(3.25, 3);
    expect(raycastCloud(cloud, [6.4e6 + 0.5, 1, 10], [0, 0, 1])).toBeNull();
    expect(raycastCloud(cloud, [6.4e6 + 1.2, 1, 10], [0, 0, -1])?.distance).toBeCloseTo(6.75, 3);
    expect(raycastCloud(cloud, [6.4e6 + 1.3, 1, 10], [0, 0, -1])).toBeNull();
    expect(raycastCloud(cloud, [6.4e6 + 0.5, 1, 1], [0, 1, 0])).toEqual({
      distance: 0,
      point: [6.4e6 + 0.5, 1, 1],
    });
  });

  test('a single splat can be hit; empty clouds and non-finite rays cannot', () => {
    const one = packOf([{ position: [0, 0, 0], logScales: [-1, -1, -1] }]);
    expect(raycastCloud(one, [0.3, 0.3, 5], [0, 0, -1])?.distance).toBeCloseTo(5 - Math.exp(-1), 2);
    expect(raycastCloud(packOf([]), [0, 0, 5], [0, 0, -1])).toBeNull();
    expect(raycastCloud(one, [0, 0, 5], [0, 0, 0])).toBeNull();
    expect(raycastCloud(one, [0, 0, Number.NaN], [0, 0, -1])).toBeNull();
    expect(raycastCloud(one, [0, 0, 5], [0, 0, Number.NEGATIVE_INFINITY])).toBeNull();
  });

  test('one large splat does not widen its chunk beyond an eighth of the box', () => {
    const splats = Array.from({ length: 512 }, (_, i) => ({
      position: [i < 256 ? 0 : 10, (i % 16) / 15, (Math.floor(i / 16) % 16) / 15],
      logScales: i % 256 === 7 ? [3, 3, 3] : [-6, -6, -6],
    }));
    const cloud = packOf(splats);
    expect(raycastCloud(cloud, [20, 0.5, 0.5], [-1, 0, 0])?.distance).toBeCloseTo(10 - 1 / 8, 4);
    expect(raycastCloud(cloud, [5, 0.5, 0.5], [-1, 0, 0])?.distance).toBeCloseTo(5 - 1 / 8, 4);
    expect(raycastCloud(cloud, [5, 0.5, 0.5], [0, 1, 0])).toBeNull();
  });

  test('a camera inside a capture is not inside the boxes of the few splats scattered around it', () => {
    const scene = randomSplats({ count: 256 * 80, shDegree: 0, logScales: [-9, -8] });
    const scattered = randomSplats({ count: 200, shDegree: 0, logScales: [-9, -8], halfExtent: 60, seed: 2 });
    const positions = Float32Array.from([...scene.positions, ...scattered.positions]);
    // A room: nothing within half of its walls.
    for (let i = 0; i < 3 * scene.count; i += 3) {
      const far = Math.max(...positions.subarray(i, i + 3).map(Math.abs));
      for (let axis = 0; axis < 3; axis++) positions[i + axis] *= (0.8 + 0.2 * far) / far;
    }
    const both = randomSplats({ count: scene.count + scattered.count, shDegree: 0, logScales: [-9, -8] });
    const cloud = pack({ ...both, positions });
    expect(cloud.bounds.max[0]).toBeGreaterThan(40);
    for (const direction of [
      [1, 0, 0],
      [0, -1, 0],
      [0.3, 0.2, 0.9],
    ] as const) {
      const hit = raycastCloud(cloud, [0, 0, 0], direction);
      expect(hit?.distance).toBeGreaterThan(0.1);
      expect(Math.max(...hit!.point.map(Math.abs))).toBeLessThan(1.1);
    }
  });

  test('tests few of the chunks of six million splats, and builds its tree once', () => {
    const chunkCount = 23_000;
    const cloud = sphereOfChunks(chunkCount);
    const tree = chunkTree(cloud);
    expect(chunkTree({ ...cloud })).toBe(tree);
    const random = seededRandom(3);
    const rays = Array.from({ length: 1000 }, () => {
      const point = () => [0, 1, 2].map(() => 6 * random() - 3) as [number, number, number];
      const [origin, target] = [point(), point()];
      return { origin, direction: target.map((value, axis) => value - origin[axis]) as typeof origin };
    });
    let hits = 0;
    let tested = 0;
    let mostTested = 0;
    for (const { origin, direction } of rays) {
      const { testedBoxes } = tree.nearestEntry(origin, direction);
      tested += testedBoxes;
      mostTested = Math.max(mostTested, testedBoxes);
      const hit = raycastCloud(cloud, origin, direction);
      if (!hit) continue;
      hits++;
      // On the sphere, up to the thickness of the chunks.
      expect(Math.hypot(...hit.point)).toBeCloseTo(1, 0);
    }
    expect(hits).toBeGreaterThan(100);
    expect(tested / rays.length).toBeLessThan(chunkCount / 100);
    expect(mostTested).toBeLessThan(chunkCount / 20);
  });
});
