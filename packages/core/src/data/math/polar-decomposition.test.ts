import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { rotationMatrixOf } from '../editing/quaternion.ts';
import { type Mat3, transform3 } from './mat4.ts';
import { polarDecomposition } from './polar-decomposition.ts';

function product(a: Mat3, b: Mat3): Mat3 {
  return [0, 3, 6].flatMap((column) => transform3(a, b.slice(column, column + 3)));
}

function transposed(m: Mat3): Mat3 {
  return [m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]];
}

const component = fc.double({ min: -1, max: 1, noNaN: true });
const rotation = fc
  .tuple(component, component, component, component)
  .filter((q) => Math.hypot(...q) > 0.1)
  .map((q) => [...rotationMatrixOf(q)] as Mat3);
/** Six orders of magnitude, in both directions. */
const length = fc.double({ min: -3, max: 3, noNaN: true }).map((exponent) => 10 ** exponent);

describe('polarDecomposition', () => {
  test('finds the rotation and the stretch that a matrix was made of', () => {
    const mirror = fc.constantFrom(1, -1);
    fc.assert(
      fc.property(rotation, rotation, length, length, length, mirror, (turn, axes, x, y, z, sign) => {
        const expectedTurn = turn.map((value) => sign * value);
        const expectedStretch = product(product(axes, [x, 0, 0, 0, y, 0, 0, 0, z]), transposed(axes));
        const found = polarDecomposition(product(expectedTurn, expectedStretch))!;
        const largest = Math.max(x, y, z);
        const smallest = Math.min(x, y, z);
        for (let i = 0; i < 9; i++) {
          // Rounding of the product's smallest stretch beside its largest turns the axes.
          expect(Math.abs(found.rotation[i] - expectedTurn[i])).toBeLessThan((1e-14 * largest) / smallest);
          expect(Math.abs(found.stretch[i] - expectedStretch[i])).toBeLessThan(1e-13 * largest);
        }
      }),
    );
  });

  test('a mirror is a rotation that mirrors, and no stretch', () => {
    const { rotation: turn, stretch } = polarDecomposition([-2, 0, 0, 0, 2, 0, 0, 0, 2])!;
    expect(turn).toEqual([-1, 0, 0, 0, 1, 0, 0, 0, 1]);
    expect(stretch).toEqual([2, 0, 0, 0, 2, 0, 0, 0, 2]);
  });

  test('singular matrices, and those that are not finite, have none', () => {
    for (const m of [
      [1, 0, 0, 0, 1, 0, 0, 0, 0],
      [0, 0, 0, 0, 0, 0, 0, 0, 0],
      [1, 2, 3, 2, 4, 6, 0, 0, 1],
      [Number.NaN, 0, 0, 0, 1, 0, 0, 0, 1],
      [Number.POSITIVE_INFINITY, 0, 0, 0, 1, 0, 0, 0, 1],
    ])
      expect(polarDecomposition(m)).toBeNull();
  });
});
