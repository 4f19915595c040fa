import { describe, expect, test } from 'vitest';
import { applied, centersOf, coefficientsOf, expectInvalid } from '../../testing/edited-splats.ts';
import { randomSplats, splatsOf } from '../../testing/random-splats.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { splatErrors } from '../../testing/splat-errors.ts';
import type { Vec3 } from '../math/mat4.ts';
import { shRestBasis } from '../splats/spherical-harmonics.ts';
import type { ShDegree } from '../splats/splat-set.ts';
import { IDENTITY, type Quaternion, rotationMatrixOf } from './quaternion.ts';
import { transformSplats } from './transform-splats.ts';

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

  test('unchanged values keep their bits', () => {
    const set = randomSplats({ count: 3 });
    expect(transformSplats(set, {})).toBe(set);
    expect(transformSplats(set, { rotation: [-2, 0, 0, 0], scale: 1 })).toBe(set);
    const shifted = transformSplats(set, { translation: [1, 0, 0] });
    expect(shifted.rotations).toBe(set.rotations);
    expect(shifted.logScales).toBe(set.logScales);
    expect(shifted.harmonics).toBe(set.harmonics);
  });

  test('an origin far away keeps digits that float32 would lose', () => {
    const set = randomSplats({ count: 20 });
    const shifted = transformSplats(set, { translation: [4_500_000, 0, 0] });
    expect(shifted.origin[0]).toBeCloseTo(4_500_000, -1);
    expect(
      splatErrors(transformSplats(shifted, { translation: [-4_500_000, 0, 0] }), set).position,
    ).toBeLessThan(1e-6);
  });

  test('values that are no transformation are refused', () => {
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
