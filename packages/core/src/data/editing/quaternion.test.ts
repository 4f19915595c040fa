import { describe, expect, test } from 'vitest';
import { applied, expectInvalid } from '../../testing/edited-splats.ts';
import type { Vec3 } from '../math/mat4.ts';
import { AXIS_NAMES, rotationByDegrees, rotationMatrixOf, uprightRotation } from './quaternion.ts';

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
