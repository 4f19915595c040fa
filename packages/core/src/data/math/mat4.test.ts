import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { uniform } from '../../testing/uniform.ts';
import { identity4, invert3, linearPart, multiply4, stretchBound, transform3, translated4 } from './mat4.ts';

const number = uniform(-100, 100);
const matrix4 = fc.array(number, { minLength: 16, maxLength: 16 });
const matrix3 = fc.array(number, { minLength: 9, maxLength: 9 });
const vector3 = fc.tuple(number, number, number);

const apply4 = (m: ArrayLike<number>, v: readonly number[]) =>
  [0, 1, 2, 3].map((r) => m[r] * v[0] + m[4 + r] * v[1] + m[8 + r] * v[2] + m[12 + r] * v[3]);

const determinant = ([a, b, c, d, e, f, g, h, i]: readonly number[]) =>
  a * (e * i - f * h) - d * (b * i - c * h) + g * (b * f - c * e);

describe('matrices', () => {
  test('a product applies one matrix after the other', () => {
    fc.assert(
      fc.property(matrix4, matrix4, vector3, (a, b, v) => {
        const together = apply4(multiply4(a, b), [...v, 1]);
        const inTurn = apply4(a, apply4(b, [...v, 1]));
        for (const [i, value] of together.entries()) expect(Math.abs(value - inTurn[i])).toBeLessThan(1e-6);
      }),
    );
    expect(multiply4(identity4(), identity4())).toEqual(identity4());
  });

  test('a translation before a matrix moves its argument', () => {
    fc.assert(
      fc.property(matrix4, vector3, vector3, (m, offset, v) => {
        const moved = apply4(translated4(m, offset), [...v, 1]);
        const expected = apply4(m, [v[0] + offset[0], v[1] + offset[1], v[2] + offset[2], 1]);
        for (const axis of [0, 1, 2]) expect(Math.abs(moved[axis] - expected[axis])).toBeLessThan(1e-7);
      }),
    );
  });

  test('an inverse undoes its matrix', () => {
    fc.assert(
      fc.property(matrix3, vector3, (m, v) => {
        const inverse = invert3(m);
        if (!inverse) return;
        const back = transform3(inverse, transform3(m, v));
        // A cofactor is a difference of products, and off by some ulps of them, however small it
        // is; divided by the determinant and multiplied with the matrix again, that is up to
        // stretch³/|determinant|. The rounding of the two products grows with how much the matrix
        // squeezes and stretches.
        const stretch = stretchBound(m);
        const growth = stretch ** 3 / Math.abs(determinant(m)) + stretch * stretchBound(inverse);
        const bound = 64 * Number.EPSILON * growth * Math.hypot(...v);
        for (const axis of [0, 1, 2])
          expect(Math.abs(back[axis] - v[axis])).toBeLessThanOrEqual(bound + Number.MIN_VALUE);
      }),
    );
  });

  test('matrices of any scale have an inverse; singular and non-finite ones have none', () => {
    for (const scale of [1e-200, 1e-20, 1, 1e20, 1e200]) {
      const inverse = invert3([2 * scale, 0, 0, 0, 4 * scale, 0, 0, 0, -5 * scale])!;
      expect(inverse[0] * scale).toBeCloseTo(0.5, 12);
      expect(inverse[4] * scale).toBeCloseTo(0.25, 12);
      expect(inverse[8] * scale).toBeCloseTo(-0.2, 12);
    }
    expect(invert3(new Float64Array(9))).toBeNull();
    expect(invert3([1, 2, 3, 2, 4, 6, 0, 0, 1])).toBeNull();
    expect(invert3([1, 0, 0, 0, 1, 0, 0, 0, 0])).toBeNull();
    expect(invert3([Number.NaN, 0, 0, 0, 1, 0, 0, 0, 1])).toBeNull();
    expect(invert3([Number.POSITIVE_INFINITY, 0, 0, 0, 1, 0, 0, 0, 1])).toBeNull();
  });

  test('no vector is lengthened beyond the bound', () => {
    fc.assert(
      fc.property(matrix3, vector3, (m, v) => {
        // Rounding: relative, and absolute if products are denormal.
        const bound = stretchBound(m) * Math.hypot(...v) * (1 + 1e-12) + 10 * Number.MIN_VALUE;
        expect(Math.hypot(...transform3(m, v))).toBeLessThanOrEqual(bound);
      }),
    );
  });

  test('the linear part leaves the translation out', () => {
    const m = Float64Array.from({ length: 16 }, (_, i) => i);
    expect(Array.from(linearPart(m))).toEqual([0, 1, 2, 4, 5, 6, 8, 9, 10]);
  });
});
