import { describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../errors.ts';
import type { Vec3 } from '../math/mat4.ts';
import { type Harmonics, readCoefficients } from '../packing/harmonics.ts';
import { shRestBasis } from '../splats/spherical-harmonics.ts';
import { coefficientsPerSplat, type ShDegree, type SplatSet } from '../splats/splat-set.ts';
import { randomSplats, splatsOf } from '../testing/random-splats.ts';
import { seededRandom } from '../testing/seeded-random.ts';
import { splatErrors } from '../testing/splat-errors.ts';
import { cropSplats } from './crop-splats.ts';
import { limitDegree } from './limit-degree.ts';
import { mergeSplats } from './merge-splats.ts';
import {
  AXIS_NAMES,
  IDENTITY,
  type Quaternion,
  rotationByDegrees,
  rotationMatrixOf,
  uprightRotation,
} from './quaternion.ts';
import { transformSplats } from './transform-splats.ts';

function coefficientsOf({ harmonics }: SplatSet<Harmonics>, splat: number): Float64Array {
  const values = new Float64Array(coefficientsPerSplat(harmonics.degree));
  readCoefficients(harmonics, splat, values);
  return values;
}

/** Centres in the scene's space. */
const centersOf = ({ positions, origin }: SplatSet<Harmonics>) =>
  Array.from(positions, (value, i) => value + origin[i % 3]);

const applied = (m: Float64Array, [x, y, z]: readonly number[]) =>
  [0, 1, 2].map((axis) => m[axis] * x + m[3 + axis] * y + m[6 + axis] * z);

const expectInvalid = (argument: string, work: () => unknown) => {
  expect(work).toThrow(InvalidArgumentError);
  expect(work).toThrow(expect.objectContaining({ argument }));
};

describe('limitDegree', () => {
  test.each<ShDegree>([0, 1, 2])('keeps the bands up to %i as they are', (degree) => {
    const set = randomSplats({ count: 5, shDegree: 3 });
    const limited = limitDegree(set, degree);
    expect(limited.harmonics.degree).toBe(degree);
    for (let i = 0; i < 5; i++)
      expect(coefficientsOf(limited, i)).toEqual(
        coefficientsOf(set, i).subarray(0, coefficientsPerSplat(degree)),
      );
  });

  test('changes nothing where there are no higher ones', () => {
    const set = randomSplats({ count: 2, shDegree: 1 });
    expect(limitDegree(set, 1)).toBe(set);
    expect(limitDegree(set, 3)).toBe(set);
  });
});

describe('cropSplats', () => {
  test('keeps what is within, sides included, as it is', () => {
    const set = { ...randomSplats({ count: 100, shDegree: 1 }), origin: [1e6, 0, -7] as const };
    const min: Vec3 = [1e6 - 1, -1, -8];
    const max: Vec3 = [1e6 + set.positions[21], 1, -6];
    const centers = centersOf(set);
    const expected = [...set.fileIndices].filter((i) =>
      [0, 1, 2].every((axis) => centers[3 * i + axis] >= min[axis] && centers[3 * i + axis] <= max[axis]),
    );
    expect(expected).toContain(7);
    expect(expected.length).toBeLessThan(100);
    const cropped = cropSplats(set, { min, max });
    expect([...cropped.fileIndices]).toEqual(expected);
    for (const [i, from] of expected.entries()) {
      expect(cropped.positions.subarray(3 * i, 3 * i + 3)).toEqual(
        set.positions.subarray(3 * from, 3 * from + 3),
      );
      expect(coefficientsOf(cropped, i)).toEqual(coefficientsOf(set, from));
    }
    expect(cropped.origin).toBe(set.origin);
  });

  test('wants a box with something in it', () => {
    const set = splatsOf([{ position: [1, 2, 3] }]);
    expect(cropSplats(set, { min: [1, 2, 3], max: [1, 2, 3] }).count).toBe(1);
    expectInvalid('box', () => cropSplats(set, { min: [0, 0, 0], max: [1, 1, 1] }));
    expectInvalid('box', () => cropSplats(set, { min: [0, 2, 0], max: [1, 1, 1] }));
    expectInvalid('box', () => cropSplats(set, { min: [0, Number.NaN, 0], max: [1, 1, 1] }));
  });
});

describe('mergeSplats', () => {
  test('puts set after set, with the highest degree', () => {
    const [a, b] = [
      randomSplats({ count: 3, shDegree: 1 }),
      randomSplats({ count: 2, seed: 2, shDegree: 3 }),
    ];
    const merged = mergeSplats([
      { ...a, dropped: { 'non-finite-color': 1 } },
      { ...b, dropped: { 'non-finite-color': 2, 'non-finite-scale': 1 } },
    ]);
    expect(merged).toMatchObject({ count: 5, origin: [0, 0, 0], harmonics: { degree: 3 } });
    expect(merged.dropped).toEqual({ 'non-finite-color': 3, 'non-finite-scale': 1 });
    expect([...merged.fileIndices]).toEqual([0, 1, 2, 3, 4]);
    for (const column of ['positions', 'logScales', 'rotations', 'opacityLogits', 'colorDc'] as const)
      expect([...merged[column]]).toEqual([...a[column], ...b[column]]);
    expect([...coefficientsOf(merged, 2)]).toEqual([...coefficientsOf(a, 2), ...new Array(36).fill(0)]);
    expect(coefficientsOf(merged, 3)).toEqual(coefficientsOf(b, 0));
  });

  test('takes positions of several origins to one that suits all', () => {
    const a = randomSplats({ count: 3, origin: [4_500_000, 0, 0] });
    const b = randomSplats({ count: 3, seed: 2, origin: [4_500_100, 0, 0] });
    const merged = mergeSplats([a, b]);
    expect(merged.origin[0]).toBeCloseTo(4_500_050, -1);
    // Relative positions are within 64 of the origin.
    const bound = 64 * 2 ** -24;
    for (const [i, center] of [...centersOf(a), ...centersOf(b)].entries())
      expect(Math.abs(centersOf(merged)[i] - center)).toBeLessThanOrEqual(bound);
    expect(mergeSplats([a, a]).origin).toEqual(a.origin);
  });

  test('is antialiased only where all say so', () => {
    const sets = (...flags: (boolean | undefined)[]) =>
      flags.map((isAntialiased) => ({ ...randomSplats({ count: 1 }), isAntialiased }));
    expect(mergeSplats(sets(true, true)).isAntialiased).toBe(true);
    expect(mergeSplats(sets(false, false)).isAntialiased).toBe(false);
    expect(mergeSplats(sets(true, false)).isAntialiased).toBeUndefined();
    expect(mergeSplats(sets(undefined, true)).isAntialiased).toBeUndefined();
  });

  test('of one set is that set, and of none is nothing', () => {
    const set = randomSplats({ count: 1 });
    expect(mergeSplats([set])).toBe(set);
    expectInvalid('sets', () => mergeSplats([]));
  });
});

describe('rotations', () => {
  test.each(AXIS_NAMES)('%s becomes +y exactly', (name) => {
    const sign = name.startsWith('-') ? -1 : 1;
    const axis = [0, 0, 0];
    axis['xyz'.indexOf(name.at(-1)!)] = sign;
    const matrix = rotationMatrixOf(uprightRotation(name));
    expect(applied(matrix, axis).map((value) => value + 0)).toEqual([0, 1, 0]);
  });

  test('a scene whose −y is up is turned about x, as the viewer does', () => {
    expect(applied(rotationMatrixOf(uprightRotation('-y')), [1, 2, 3])).toEqual([1, -2, -3]);
    expectInvalid('up', () => uprightRotation('up'));
  });

  test.each<[Vec3, Vec3, Vec3]>([
    [
      [90, 0, 0],
      [1, 2, 3],
      [1, -3, 2],
    ],
    [
      [0, 90, 0],
      [1, 2, 3],
      [3, 2, -1],
    ],
    [
      [0, 0, -270],
      [1, 2, 3],
      [-2, 1, 3],
    ],
    [
      [180, 0, 0],
      [1, 2, 3],
      [1, -2, -3],
    ],
    // First about x, then about y.
    [
      [90, -90, 360],
      [1, 2, 3],
      [-2, -3, 1],
    ],
  ])('by %j degrees, %j becomes %j exactly', (degrees, point, expected) => {
    expect(applied(rotationMatrixOf(rotationByDegrees(degrees)), point)).toEqual(expected);
  });

  test('by other angles', () => {
    const [x, y] = applied(rotationMatrixOf(rotationByDegrees([0, 0, 30])), [1, 0, 0]);
    expect([x, y]).toEqual([expect.closeTo(Math.sqrt(3) / 2, 14), expect.closeTo(1 / 2, 14)]);
  });
});

describe('transformSplats', () => {
  const random = seededRandom(5);
  const rotation = [0, 0, 0, 0].map(() => random() - 0.5) as unknown as Quaternion;
  const matrix = rotationMatrixOf(rotation);

  test('moves centres: scaled, turned, then shifted', () => {
    const set = randomSplats({ count: 50, origin: [3, -4, 5] });
    const translation: Vec3 = [0.5, 100, -7];
    const moved = centersOf(transformSplats(set, { rotation, scale: 3, translation }));
    const centers = centersOf(set);
    for (let i = 0; i < 50; i++) {
      const turned = applied(
        matrix,
        centers.slice(3 * i, 3 * i + 3).map((value) => 3 * value),
      );
      for (let axis = 0; axis < 3; axis++)
        expect(Math.abs(moved[3 * i + axis] - turned[axis] - translation[axis])).toBeLessThanOrEqual(
          2 ** -17,
        );
    }
  });

  test.each<ShDegree>([0, 1, 2, 3])('colours of degree %i turn with the splats', (shDegree) => {
    const set = randomSplats({ count: 5, shDegree });
    const turned = transformSplats(set, { rotation });
    const length = Math.hypot(1, 2, 3);
    const before = [1 / length, -2 / length, 3 / length];
    const basisBefore = shRestBasis(shDegree, before[0], before[1], before[2]);
    const [x, y, z] = applied(matrix, before);
    const basisAfter = shRestBasis(shDegree, x, y, z);
    const redOf = (values: Float64Array, basis: readonly number[]) =>
      basis.reduce((sum, value, k) => sum + value * values[3 * k], 0);
    for (let i = 0; i < 5; i++) {
      const red = redOf(coefficientsOf(set, i), basisBefore);
      expect(redOf(coefficientsOf(turned, i), basisAfter)).toBeCloseTo(red, 6);
    }
  });

  test('axes turn and grow', () => {
    const set = randomSplats({ count: 20, shDegree: 0 });
    set.rotations.fill(0, 0, 4);
    const { rotations, logScales } = transformSplats(set, { rotation, scale: 0.5 });
    for (let i = 0; i < 20; i++) {
      const row = [...set.rotations.subarray(4 * i, 4 * i + 4)] as unknown as Quaternion;
      const before = rotationMatrixOf(i === 0 ? IDENTITY : row);
      const after = rotationMatrixOf([...rotations.subarray(4 * i, 4 * i + 4)] as unknown as Quaternion);
      for (let column = 0; column < 9; column += 3) {
        const turned = applied(matrix, [...before.subarray(column, column + 3)]);
        for (let k = 0; k < 3; k++) expect(after[column + k]).toBeCloseTo(turned[k], 6);
      }
    }
    expect([...logScales]).toEqual([...set.logScales].map((value) => Math.fround(value - Math.LN2)));
  });

  test('back again it is as it was, but for rounding', () => {
    const set = randomSplats({ count: 30 });
    const [w, x, y, z] = rotation;
    const turned = transformSplats(set, { rotation, scale: 4 });
    const errors = splatErrors(transformSplats(turned, { rotation: [w, -x, -y, -z], scale: 1 / 4 }), set);
    for (const error of Object.values(errors)) expect(error).toBeLessThan(2e-6);
    const upright = transformSplats(set, { rotation: [0, 1, 0, 0] });
    expect(splatErrors(transformSplats(upright, { rotation: [0, 1, 0, 0] }), set).position).toBe(0);
  });

  test('what is not changed keeps its bits', () => {
    const set = randomSplats({ count: 3 });
    expect(transformSplats(set, {})).toBe(set);
    expect(transformSplats(set, { rotation: [-2, 0, 0, 0], scale: 1 })).toBe(set);
    const shifted = transformSplats(set, { translation: [1, 0, 0] });
    expect(shifted.rotations).toBe(set.rotations);
    expect(shifted.logScales).toBe(set.logScales);
    expect(shifted.harmonics).toBe(set.harmonics);
  });

  test('far away, an origin keeps what float32 could not', () => {
    const set = randomSplats({ count: 20 });
    const shifted = transformSplats(set, { translation: [4_500_000, 0, 0] });
    expect(shifted.origin[0]).toBeCloseTo(4_500_000, -1);
    expect(
      splatErrors(transformSplats(shifted, { translation: [-4_500_000, 0, 0] }), set).position,
    ).toBeLessThan(1e-6);
  });

  test('what is no transformation is refused', () => {
    const set = randomSplats({ count: 1 });
    expectInvalid('scale', () => transformSplats(set, { scale: 0 }));
    expectInvalid('scale', () => transformSplats(set, { scale: Number.NaN }));
    expectInvalid('rotation', () => transformSplats(set, { rotation: [0, 0, 0, 0] }));
    expectInvalid('translation', () =>
      transformSplats(set, { translation: [0, Number.POSITIVE_INFINITY, 0] }),
    );
    expectInvalid('set', () => transformSplats(splatsOf([{ position: [1, 0, 0] }, {}]), { scale: 1e39 }));
  });
});
