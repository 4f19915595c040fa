import type { SplatSet } from '@websplatter/core';
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import type { FloaterFilter } from '../state/selecting.ts';
import { floaterTest, NEIGHBOURS } from './floaters.ts';

/** Round splats at these places: x, y, z … */
function cloudAt(places: ArrayLike<number>, modelMatrix: readonly number[] | null = null) {
  const count = places.length / 3;
  const set: SplatSet = {
    count,
    origin: [5, 0, 0],
    positions: Float32Array.from(places, (value, i) => (i % 3 === 0 ? value - 5 : value)),
    logScales: new Float32Array(3 * count).fill(Math.log(0.01)),
    rotations: new Float32Array(4 * count),
    opacityLogits: new Float32Array(count).fill(2),
    colorDc: new Float32Array(3 * count),
    harmonics: { degree: 0, coefficients: new Float32Array() },
    fileIndices: Uint32Array.from({ length: count }, (_, i) => i),
    dropped: {},
  };
  return { set, modelMatrix };
}

type Cloud = ReturnType<typeof cloudAt>;

function found(clouds: readonly Cloud[], filter: FloaterFilter, limit: number): number[][] {
  const isFloater = floaterTest(clouds, filter, limit);
  return clouds.map((cloud) => [...cloud.set.fileIndices].filter((i) => isFloater(cloud, i)));
}

/** A grid of 4³ splats, 0.1 apart, on both sides of 0. */
const BLOCK = Array.from({ length: 64 }, (_, i) => [i & 3, (i >> 2) & 3, i >> 4].map((k) => 0.1 * (k - 1.5)));
const HALF = [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1];

describe('splats far from others', () => {
  it('are those without enough neighbours, also a few that stray together', () => {
    const strays = [
      [3, 0, 0],
      [3.01, 0, 0],
      [-40, 7, 9e6],
    ];
    const clouds = [cloudAt([...BLOCK, ...strays].flat())];
    expect(found(clouds, 'far', 0.3)).toEqual([[64, 65, 66]]);
    expect(found(clouds, 'far', 1e-4)[0]).toHaveLength(67);
    // A corner has 7 others within 0.18, and 10 within 0.21.
    expect(found(clouds, 'far', 0.18)[0].length).toBeGreaterThan(10);
    expect(found(clouds, 'far', 0.21)).toEqual([[64, 65, 66]]);
  });

  it('are judged beside the splats of other files, where these stand', () => {
    const few = BLOCK.slice(0, 4).flat();
    const others = BLOCK.flatMap((place) => place.map((value) => 2 * value));
    expect(found([cloudAt(few)], 'far', 0.3)).toEqual([[0, 1, 2, 3]]);
    expect(found([cloudAt(few), cloudAt(others, HALF)], 'far', 0.3)).toEqual([[], []]);
  });

  it('are found as by brute force', () => {
    const place = fc.double({ min: -2, max: 2, noNaN: true });
    fc.assert(
      fc.property(
        fc.array(fc.tuple(place, place, place), { minLength: 1, maxLength: 60 }),
        fc.double({ min: 0.05, max: 3, noNaN: true }),
        (places, radius) => {
          const cloud = cloudAt(places.flat());
          const { positions } = cloud.set;
          const at = (i: number) => [5 + positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]];
          const far = places.flatMap((_, i) => {
            const near = places.filter((_each, j) => {
              const [x, y, z] = at(j).map((value, axis) => value - at(i)[axis]);
              return x * x + y * y + z * z <= radius * radius;
            });
            return near.length <= NEIGHBOURS ? [i] : [];
          });
          expect(found([cloud], 'far', radius)).toEqual([far]);
        },
      ),
    );
  });

  it('are found among 700,000 in seconds, with progress', () => {
    const count = 700_000;
    const places = new Float32Array(3 * count);
    // A sheet of 1000 by 700, of which each thousandth splat floats above.
    for (let i = 0; i < count; i++)
      places.set([(i % 1000) / 1000, Math.floor(i / 1000) / 1000, i % 1009 === 0 ? 1 + i / count : 0], 3 * i);
    const parts: number[] = [];
    const cloud = cloudAt(places);
    const start = process.cpuUsage();
    const isFar = floaterTest([cloud], 'far', 0.005, (part) => parts.push(part));
    const far = [...cloud.set.fileIndices].filter((i) => isFar(cloud, i));
    // Unlike time by the clock, CPU time does not grow while other processes keep the machine busy.
    expect(process.cpuUsage(start).user).toBeLessThan(14e6);
    expect(far.length).toBe(Math.ceil(count / 1009));
    expect(far.every((i) => i % 1009 === 0)).toBe(true);
    expect(parts.length).toBeGreaterThan(10);
    expect(parts).toEqual([...parts].sort((a, b) => a - b));
  });
});

it('splats are huge as they stand in the scene, faint by opacity, needles by their longest axis', () => {
  const cloud = cloudAt(BLOCK.slice(0, 4).flat(), HALF);
  const { set } = cloud;
  set.logScales.set(
    [0, 0, -9].map((value) => value + Math.log(2)),
    3,
  );
  set.opacityLogits[2] = -4;
  set.logScales[9] = Math.log(0.2);
  expect(found([cloud], 'huge', 1)).toEqual([[1]]);
  expect(found([cloud], 'huge', 1.01)).toEqual([[]]);
  expect(found([cloud], 'faint', 0.02)).toEqual([[2]]);
  // The second one is a disc.
  expect(found([cloud], 'needle', 19.9)).toEqual([[3]]);
  expect(found([cloud], 'needle', 20.1)).toEqual([[]]);
});
