import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { randomSplats } from '../../testing/random-splats.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { uniform } from '../../testing/uniform.ts';
import { Turns } from '../turns.ts';
import {
  MORTON_DIGITS,
  MORTON_SHIFTS,
  type MortonFrame,
  mortonCell,
  mortonDigits,
  mortonFrame,
  mortonOrder,
  mortonOrderInTurns,
  permuteSplats,
} from './morton-order.ts';

/** 48-bit Morton code of cell coordinates, bit by bit. */
function mortonCode(cell: readonly number[]): number {
  let code = 0;
  for (let bit = 15; bit >= 0; bit--) {
    for (let axis = 2; axis >= 0; axis--) code = 2 * code + ((cell[axis] >> bit) & 1);
  }
  return code;
}

const coordinate = uniform(-1000, 1000);

/** Largest float32, least normal one and least of all. */
const [HUGEST, NORMAL, TINIEST] = [3.4028234663852886e38, 2 ** -126, 2 ** -149];

/** Cells of coordinates along one axis, and the frame that they are counted in. */
function cellsAlong(coordinates: readonly number[]): { cells: number[]; frame: MortonFrame } {
  const values = Float32Array.from(coordinates);
  const frame = mortonFrame([Math.min(...values), 0, 0], [Math.max(...values), 0, 0]);
  return { cells: Array.from(values, (value) => mortonCell(value, 0, frame)), frame };
}

describe('cells of Morton codes', () => {
  test('are as many for tiny clouds and huge ones as for others', () => {
    for (const size of [1, 1e-30, 1e30, 2 ** 30 * NORMAL, HUGEST / 2]) {
      for (const base of [0, size, -size / 3]) {
        const { cells } = cellsAlong([0, 0.25, 0.5, 0.75, 1].map((part) => base + part * size));
        for (const [i, cell] of cells.entries())
          expect(Math.abs(cell - (i * 65_535) / 4), `${base} + ${i} / 4 · ${size}`).toBeLessThanOrEqual(1);
      }
    }
    expect(cellsAlong([-HUGEST, 0, HUGEST]).cells).toEqual([0, 32_767, 65_535]);
    expect(cellsAlong([NORMAL, NORMAL + TINIEST]).cells).toEqual([0, 65_535]);
  });

  test('are 0 along an axis without extent, whatever its coordinate', () => {
    for (const coordinate of [0, -0, 7.5, -HUGEST, HUGEST, TINIEST]) {
      const frame = mortonFrame([coordinate, -1e-30, 0], [coordinate, 1e-30, 0]);
      expect(mortonCell(coordinate, 0, frame)).toBe(0);
      expect(mortonCell(1e-30, 1, frame)).toBe(65_535);
      // Shaders compute with it: infinities give any cell there.
      expect(Number.isFinite(frame.scaledMin[0])).toBe(true);
      const point = mortonFrame([coordinate, 0, 0], [coordinate, 0, 0]);
      expect(mortonCell(coordinate, 0, point)).toBe(0);
    }
  });

  test('take subnormal coordinates and −0 for 0', () => {
    const { cells, frame } = cellsAlong([-NORMAL, NORMAL]);
    expect(cells).toEqual([0, 65_535]);
    for (const value of [-0, TINIEST, -TINIEST, NORMAL - TINIEST])
      expect(mortonCell(value, 0, frame)).toBe(mortonCell(0, 0, frame));
    expect(cellsAlong([-TINIEST, 0, TINIEST]).cells).toEqual([0, 0, 0]);
  });

  test('do not decrease with the coordinate, and reach from 0 to 65535 or one less', () => {
    const any = fc.float({ noNaN: true, noDefaultInfinity: true });
    fc.assert(
      fc.property(fc.array(any, { minLength: 2, maxLength: 30 }), (coordinates) => {
        const sorted = Float32Array.from(coordinates).sort();
        const { cells, frame } = cellsAlong(Array.from(sorted));
        for (let i = 1; i < cells.length; i++) expect(cells[i]).toBeGreaterThanOrEqual(cells[i - 1]);
        expect(cells[0]).toBe(0);
        if (frame.cellsPerUnit > 0) expect(cells.at(-1)).toBeGreaterThanOrEqual(65_534);
        for (const value of [frame.scale[0], frame.scaledMin[0], frame.cellsPerUnit]) {
          expect(Math.fround(value)).toBe(value);
          expect(Number.isFinite(value)).toBe(true);
        }
      }),
      { numRuns: 1000 },
    );
  });
});

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

  test('is that of the digits, the most significant first', () => {
    const next = seededRandom(2);
    // Half of them agree in their first digit, and some of these in their second.
    const cells = Array.from({ length: 300 }, (_, i) =>
      [0, 1, 2].map(() => Math.floor(next() * [65_536, 1024, 32, 4][i % 4])),
    );
    const frame = mortonFrame([0, 0, 0], [65_535, 65_535, 65_535]);
    const rows = Float32Array.from(cells.flatMap((cell) => [...cell, 7]));
    const digits = MORTON_SHIFTS.map((shift) => mortonDigits(rows, 4, frame, shift));
    expect(Math.max(...digits.flatMap((of) => [...of]))).toBeLessThan(MORTON_DIGITS);
    const codes = cells.map(mortonCode);
    const byDigits = (a: number, b: number) => digits.map((of) => of[a] - of[b]).find((each) => each !== 0);
    const orderBy = (compare: (a: number, b: number) => number) => cells.map((_, i) => i).sort(compare);
    expect(orderBy((a, b) => byDigits(a, b) ?? 0)).toEqual(orderBy((a, b) => codes[a] - codes[b]));
  });

  test('is the same with few splats and with many, whose digits are longer', () => {
    const next = seededRandom(1);
    const columns = [0, 1, 2].map(() => Uint16Array.from({ length: 40_000 }, () => 65_536 * next()));
    const points = Array.from({ length: 40_000 }, (_, i) => columns.map((column) => column[i]));
    [points[0], points[1]] = [
      [0, 0, 0],
      [65_535, 65_535, 65_535],
    ];
    const codes = points.map(mortonCode);
    for (const count of [32_767, 32_768, 40_000]) {
      const order = mortonOrder(Float32Array.from(points.slice(0, count).flat()), count);
      const expected = Uint32Array.from({ length: count }, (_, i) => i).sort((a, b) => codes[a] - codes[b]);
      expect(order.every((index, i) => index === expected[i])).toBe(true);
    }
  });

  test('keeps the given order where all points are one, and for none and one', () => {
    for (const count of [0, 1, 2, 100])
      expect(Array.from(mortonOrder(new Float32Array(3 * count).fill(7.5), count))).toEqual(
        Array.from({ length: count }, (_, i) => i),
      );
  });

  test('is the same in turns, of which there are many, with progress that only grows', async () => {
    const { positions, count } = randomSplats({ count: 100_000, shDegree: 0 });
    class CountedTurns extends Turns {
      count = 0;
      override async give(): Promise<void> {
        this.count++;
      }
    }
    const turns = new CountedTurns(undefined);
    const told: number[] = [];
    const order = await mortonOrderInTurns(positions, count, turns, (fraction) => told.push(fraction));
    const bytesOf = (values: Uint32Array) => Buffer.from(values.buffer);
    expect(Buffer.compare(bytesOf(order), bytesOf(mortonOrder(positions, count)))).toBe(0);
    // Seven steps of 16,384 rows, eight times.
    expect(turns.count).toBe(56);
    expect(told).toEqual(told.toSorted((a, b) => a - b));
    expect([told[0] > 0, told.at(-1)]).toEqual([true, 1]);
  });

  test('ends in between when it is called off', async () => {
    const { positions, count } = randomSplats({ count: 50_000, shDegree: 0 });
    const stop = new AbortController();
    const ordering = mortonOrderInTurns(positions, count, new Turns(stop.signal), () => stop.abort('enough'));
    await expect(ordering).rejects.toBe('enough');
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

describe('single centres far outside', () => {
  const count = 16_384;
  const random = seededRandom(3);
  const scene = Array.from({ length: 3 * count }, () => random());
  const strays = [
    { name: 'none', values: [] },
    { name: 'at one place', values: [-5.3e6, -5e5, -700] },
    { name: 'on all sides', values: [-1e7, 0, 0, 0, 1e9, 0, 3e38, 0, 0, 0, -3e38, 0, 0, 0, 1e5] },
  ];

  /**
   * @fault Files: parts of a scene lie too far apart for one origin
   * @consequence other splats keep their order in space, in chunks as small as without the far part
   */
  test.each(strays)('$name: others are in chunks as small as without', ({ values }) => {
    const positions = Float32Array.from([...values, ...scene]);
    const order = mortonOrder(positions, positions.length / 3);
    const extents: number[] = [];
    for (let from = 0; from + 256 <= order.length; from += 256) {
      const chunk = Array.from(order.subarray(from, from + 256), (i) => positions[3 * i]);
      extents.push(Math.max(...chunk) - Math.min(...chunk));
    }
    // As many as of cubes of a quarter of the scene; in any other order they are as large as that.
    expect(extents.sort((a, b) => a - b)[extents.length >> 1]).toBeLessThan(0.6);
  });
});
