import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { expectInvalid } from '../../testing/edited-splats.ts';
import { normalizedRotation } from '../packing/rotation.ts';
import { type Quaternion, rotationMatrixOf } from './quaternion.ts';
import { type SplatArrays, splatsFromArrays } from './splats-from-arrays.ts';

const TWO: SplatArrays = {
  positions: [1, 2, 3, 4, 5, 6],
  scales: [1, 2, 3, 0.5, 0.5, 0.5],
  rotations: [0, 0, 0, 2, 1, 0, 0, 1],
  opacities: [0.5, 1],
  colors: [0.5, 1, 0, 0.5, 0.5, 0.5],
};
const C0 = 0.28209479177387814;

describe('splats from arrays', () => {
  test('have the values of the arrays as they are trained', () => {
    const set = splatsFromArrays(TWO);
    expect(set.count).toBe(2);
    expect([...set.positions]).toEqual([1, 2, 3, 4, 5, 6]);
    expect([...set.logScales]).toEqual([1, 2, 3, 0.5, 0.5, 0.5].map((scale) => Math.fround(Math.log(scale))));
    expect([...set.rotations]).toEqual([2, 0, 0, 0, 1, 1, 0, 0]);
    expect([...set.opacityLogits]).toEqual([0, Number.POSITIVE_INFINITY]);
    expect([...set.colorDc]).toEqual([0, 0.5, -0.5, 0, 0, 0].map((value) => Math.fround(value / C0)));
    expect(set.harmonics.degree).toBe(0);
    expect([...set.fileIndices]).toEqual([0, 1]);
    expect('isAntialiased' in set).toBe(false);
  });

  test('are opaque and not turned by default, and may be none', () => {
    const { positions, scales, colors } = TWO;
    const set = splatsFromArrays({ positions, scales, colors, isAntialiased: true });
    expect([...set.rotations]).toEqual([1, 0, 0, 0, 1, 0, 0, 0]);
    expect([...set.opacityLogits]).toEqual([Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY]);
    expect(set.isAntialiased).toBe(true);
    expect(splatsFromArrays({ positions: [], scales: [], colors: [] }).count).toBe(0);
  });

  test('keep the digits of float64 positions that are far away', () => {
    const positions = Float64Array.of(4e6 + 0.001, 0, 0, 4e6 + 0.002, 0, 0);
    const set = splatsFromArrays({ ...TWO, positions });
    expect(set.origin[0] + set.positions[3] - (set.origin[0] + set.positions[0])).toBeCloseTo(0.001, 8);
  });

  test.each([0, 1, 2, 3] as const)('have harmonics of degree %i', (degree) => {
    const width = 3 * (degree + 1) ** 2;
    const { positions, scales } = TWO;
    const sh = Float32Array.from({ length: 2 * width }, (_, i) => i / 8);
    const set = splatsFromArrays({ positions, scales, sh });
    expect(set.harmonics.degree).toBe(degree);
    expect([...set.colorDc]).toEqual([...sh.slice(0, 3), ...sh.slice(width, width + 3)]);
    expect([...set.harmonics.coefficients]).toEqual([...sh.slice(3, width), ...sh.slice(width + 3)]);
  });

  test('have the covariances that are given', () => {
    const real = fc.double({ min: -1, max: 1, noNaN: true });
    const scale = fc.double({ min: 0.01, max: 10, noNaN: true });
    fc.assert(
      fc.property(
        fc.tuple(real, real, real, real).filter((q) => Math.hypot(...q) > 0.1),
        fc.tuple(scale, scale, scale),
        (q, scales) => {
          const given = covarianceOf(q, scales);
          const set = splatsFromArrays({ positions: [0, 0, 0], covariances: given, colors: [0, 0, 0] });
          const turned = new Float64Array(4);
          normalizedRotation(set.rotations, 0, turned);
          const found = covarianceOf([...turned] as unknown as Quaternion, [...set.logScales].map(Math.exp));
          const largest = Math.max(...scales) ** 2;
          for (const [k, value] of found.entries())
            expect(Math.abs(value - given[k])).toBeLessThan(1e-5 * largest);
        },
      ),
    );
  });

  test('of flat covariances are thin, not of no size', () => {
    const set = splatsFromArrays({
      positions: [0, 0, 0],
      covariances: [1, 0, 0, 4, 0, 0],
      colors: [0, 0, 0],
    });
    expect([...set.logScales].map((each) => Math.exp(each) + 0)).toEqual([
      expect.closeTo(2, 5),
      expect.closeTo(1, 5),
      expect.closeTo(2e-6, 8),
    ]);
  });

  test.each<[string, Partial<Record<keyof SplatArrays, unknown>>, string]>([
    ['positions', { positions: undefined }, 'positions is undefined; it must be an array of numbers.'],
    ['positions', { positions: [1, 2] }, 'positions has 2 values; it must have 3 for each splat.'],
    [
      'positions',
      { positions: [1, 2, 3, 4, 5, Number.POSITIVE_INFINITY] },
      'positions[5], of splat 1, is Infinity; they are finite numbers that float32 holds.',
    ],
    ['scales', { scales: [1, 1, 1] }, 'scales has 3 values; 2 splats need 6, 3 each.'],
    [
      'scales',
      { scales: undefined },
      'scales is undefined; it must be an array of numbers. Give scales, or covariances instead.',
    ],
    ['scales', { covariances: [1, 0, 0, 1, 0, 1] }, 'There are scales beside covariances; give one of them.'],
    [
      'rotations',
      { scales: undefined, covariances: [] },
      'There are rotations beside covariances; give one of them.',
    ],
    [
      'rotations',
      { rotations: new Array(8).fill(0) },
      'rotations[0…3], of splat 0, is 0; a quaternion has a length.',
    ],
    ['opacities', { opacities: [0.5, -1] }, 'opacities[1], of splat 1, is -1; they are numbers from 0 to 1.'],
    ['opacities', { opacities: 1 }, 'opacities is 1; it must be an array of numbers.'],
    [
      'colors',
      { colors: undefined },
      'colors is undefined; it must be an array of numbers. Give colors, or sh instead.',
    ],
    [
      'colors',
      { colors: [0, 0, 0, 0, 0, Number.NaN] },
      'colors[5], of splat 1, is NaN; they are finite numbers that float32 holds.',
    ],
    ['colors', { sh: [] }, 'There are colors beside sh; give one of them.'],
    ['sh', { colors: undefined, sh: new Array(8).fill(0) }, 'sh has 8 values; 2 splats need 6, 24, 54, 96.'],
    [
      'sh',
      { colors: undefined, sh: [0, 0, 0, 0, 1e39, 0] },
      'sh[4], of splat 1, is 1e+39; they are finite numbers that float32 holds.',
    ],
    [
      'covariances',
      { scales: undefined, rotations: undefined, covariances: new Array(12).fill(0) },
      'covariances[0…5], of splat 0, has no positive variance (0 at most); a splat has a size.',
    ],
  ])('refuse wrong %s', (argument, wrong, message) => {
    const make = () => splatsFromArrays({ ...TWO, ...wrong } as SplatArrays);
    expectInvalid(argument, make);
    expect(make).toThrow(message);
  });
});

/** xx, xy, xz, yy, yz, zz. */
function covarianceOf([w, x, y, z]: readonly number[], scales: readonly number[]): number[] {
  const m = rotationMatrixOf([w, x, y, z]);
  const element = (row: number, column: number) =>
    [0, 1, 2].reduce((sum, axis) => sum + m[3 * axis + row] * scales[axis] ** 2 * m[3 * axis + column], 0);
  return [element(0, 0), element(0, 1), element(0, 2), element(1, 1), element(1, 2), element(2, 2)];
}
