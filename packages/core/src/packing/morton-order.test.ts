import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { randomSplats } from '../testing/random-splats.ts';
import { uniform } from '../testing/uniform.ts';
import { mortonOrder, permuteSplats } from './morton-order.ts';

/** 48-bit Morton code of cell coordinates, bit by bit. */
function mortonCode(cell: readonly number[]): number {
  let code = 0;
  for (let bit = 15; bit >= 0; bit--) {
    for (let axis = 2; axis >= 0; axis--) code = 2 * code + ((cell[axis] >> bit) & 1);
  }
  return code;
}

const coordinate = uniform(-1000, 1000);

describe('Morton order', () => {
  test('is a permutation for any positions', () => {
    fc.assert(
      fc.property(fc.array(fc.tuple(coordinate, coordinate, coordinate), { maxLength: 300 }), (points) => {
        const order = mortonOrder(Float32Array.from(points.flat()), points.length);
        expect(Array.from(order).sort((a, b) => a - b)).toEqual(points.map((_, i) => i));
      }),
    );
  });

  test('is that of the codes, equal ones in the order given', () => {
    const cell = fc.tuple(...[0, 1, 2].map(() => fc.oneof(fc.nat(3), fc.nat(65_535)))) as fc.Arbitrary<
      number[]
    >;
    fc.assert(
      fc.property(fc.array(cell, { maxLength: 200 }), (cells) => {
        // The corners fix the bounds, so that coordinates are cells.
        const points = [[0, 0, 0], [65_535, 65_535, 65_535], ...cells];
        const order = mortonOrder(Float32Array.from(points.flat()), points.length);
        const codes = points.map(mortonCode);
        const expected = points.map((_, i) => i).sort((a, b) => codes[a] - codes[b] || a - b);
        expect(Array.from(order)).toEqual(expected);
      }),
    );
  });

  test('keeps the given order where all points are one, and for none and one', () => {
    for (const count of [0, 1, 2, 100])
      expect(Array.from(mortonOrder(new Float32Array(3 * count).fill(7.5), count))).toEqual(
        Array.from({ length: count }, (_, i) => i),
      );
  });

  test('makes neighbours in space neighbours in memory: runs have small bounds', () => {
    const { positions, count } = randomSplats({ count: 20_000, shDegree: 0 });
    const order = mortonOrder(positions, count);
    const volumeOf = (indexAt: (i: number) => number) => {
      let volume = 0;
      for (let start = 0; start < count; start += 250) {
        let box = 1;
        for (const axis of [0, 1, 2]) {
          const along = Array.from({ length: 250 }, (_, i) => positions[3 * indexAt(start + i) + axis]);
          box *= Math.max(...along) - Math.min(...along);
        }
        volume += box;
      }
      return volume;
    };
    // Perfect cubes would fill the cube of 2³ once; as given, nearly every run spans all of it.
    expect(volumeOf((i) => order[i])).toBeLessThan(8 * 8);
    expect(volumeOf((i) => i)).toBeGreaterThan(8 * 70);
  });

  test('carries every column of the splats along', () => {
    const set = randomSplats({ count: 5, shDegree: 1 });
    const order = Uint32Array.of(3, 0, 4, 2, 1);
    const permuted = permuteSplats(set, order);
    expect(permuted.fileIndices).toEqual(order);
    for (const [to, from] of order.entries()) {
      for (const [column, width] of [
        ['positions', 3],
        ['logScales', 3],
        ['rotations', 4],
        ['opacityLogits', 1],
        ['colorDc', 3],
      ] as const) {
        expect(permuted[column].subarray(to * width, (to + 1) * width)).toEqual(
          set[column].subarray(from * width, (from + 1) * width),
        );
      }
      expect(permuted.harmonics.coefficients.subarray(9 * to, 9 * to + 9)).toEqual(
        set.harmonics.coefficients.subarray(9 * from, 9 * from + 9),
      );
    }
  });
});
