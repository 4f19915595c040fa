import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { rotationMatrix } from '../../reference/covariance.ts';
import { unpackSplat } from '../../reference/packing.ts';
import { randomSplats, type SplatValues, splatsOf } from '../../testing/random-splats.ts';
import { uniform } from '../../testing/uniform.ts';
import { HALF_MAX } from '../layout/half.ts';
import { opacityOf } from '../splats/color-values.ts';
import { logScalesOf, setLogScales } from './chunks.ts';
import { packGeometry } from './geometry.ts';
import { LOG_SCALE_LIMIT, logScaleRange } from './log-scale.ts';

const finite = (limit: number) => uniform(-limit, limit).map(Math.fround);
const triple = (value: fc.Arbitrary<number>) => fc.array(value, { minLength: 3, maxLength: 3 });

const anySplat: fc.Arbitrary<SplatValues> = fc.record({
  position: triple(fc.float({ noNaN: true, noDefaultInfinity: true })),
  logScales: triple(fc.oneof(finite(12), finite(200))),
  rotation: fc.array(fc.oneof(finite(1), finite(1e30), finite(1e-30), fc.constantFrom(0, 1, -1)), {
    minLength: 4,
    maxLength: 4,
  }),
  opacityLogit: fc.oneof(
    finite(20),
    fc.constantFrom(Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY, 100, -100),
  ),
  colorDc: triple(fc.oneof(finite(4), finite(1e5))),
});
const anySplats = fc.array(anySplat, { minLength: 1, maxLength: 6 });

const clamped = (value: number, limit: number) => Math.max(-limit, Math.min(limit, value));

/** Largest difference of the rotations' matrices: blind to a quaternion's sign and length. */
function rotationError(actual: readonly number[], expected: readonly number[]): number {
  const [a, b] = [actual, expected].map(([w, x, y, z]) => rotationMatrix(w, x, y, z));
  return Math.max(...a.map((value, i) => Math.abs(value - b[i])));
}

describe('packed geometry', () => {
  test('float32: any splat comes back to within a rounding', () => {
    fc.assert(
      fc.property(anySplats, (splats) => {
        const set = splatsOf(splats);
        const geometry = packGeometry(set, 'f32');
        expect(geometry.words).toHaveLength(16 * set.count);
        for (const [i, splat] of splats.entries()) {
          const unpacked = unpackSplat(geometry, i);
          expect(unpacked.position).toEqual(splat.position);
          expect(unpacked.colorDc).toEqual(splat.colorDc);
          expect(unpacked.opacity).toBe(Math.fround(opacityOf(splat.opacityLogit!)));
          for (const axis of [0, 1, 2]) {
            const scale = Math.exp(clamped(splat.logScales![axis], LOG_SCALE_LIMIT));
            expect(unpacked.scale[axis]).toBe(Math.fround(scale));
          }
          // Four roundings of a unit quaternion, 2^-24 each, doubled by products with the others.
          expect(rotationError(unpacked.rotation, splat.rotation!)).toBeLessThan(8 * 2 ** -24);
          expect(Math.hypot(...unpacked.rotation)).toBeCloseTo(1, 6);
        }
      }),
      { numRuns: 200 },
    );
  });

  test('packed: any splat comes back to within half a step of each of its parts', () => {
    fc.assert(
      fc.property(anySplats, (splats) => {
        const set = splatsOf(splats);
        const geometry = packGeometry(set, 'packed');
        expect(geometry.words).toHaveLength(8 * set.count);
        const logScales = Array.from(set.logScales, (value) => clamped(value, LOG_SCALE_LIMIT));
        const range = Math.max(...logScales) - Math.min(...logScales);
        for (const [i, splat] of splats.entries()) {
          const unpacked = unpackSplat(geometry, i);
          expect(unpacked.position).toEqual(splat.position);
          expect(Math.abs(unpacked.opacity - opacityOf(splat.opacityLogit!))).toBeLessThanOrEqual(
            0.5 / 65_535 + 1e-12,
          );
          for (const axis of [0, 1, 2]) {
            const dc = clamped(splat.colorDc![axis], HALF_MAX);
            expect(Math.abs(unpacked.colorDc[axis] - dc)).toBeLessThanOrEqual(
              Math.max(Math.abs(dc) * 2 ** -11, 2 ** -25),
            );
            // Half a step of the range, and the step and the minimum rounded to float32.
            const error = Math.abs(Math.log(unpacked.scale[axis]) - logScales[3 * i + axis]);
            expect(error).toBeLessThanOrEqual(
              range / 65_535 / 2 + (range + LOG_SCALE_LIMIT) * 2 ** -24 + 1e-9,
            );
          }
          // Three components err by half of √½/16383 = 2.2e-5 each; the one left out, at least ½,
          // by at most their sum over its own size; matrix elements by at most 4 times the
          // quaternion's error.
          const half = Math.SQRT1_2 / 16_383 / 2;
          const quaternionError = Math.hypot(half, half, half, 3 * half * Math.SQRT2);
          expect(rotationError(unpacked.rotation, splat.rotation!)).toBeLessThan(4 * quaternionError);
        }
      }),
      { numRuns: 300 },
    );
  });

  for (const precision of ['f32', 'packed'] as const) {
    test(`${precision}: the identity and half turns about the axes are exact, a zero quaternion is the identity`, () => {
      const cases: [number[], number[]][] = [
        [
          [1, 0, 0, 0],
          [1, 0, 0, 0],
        ],
        [
          [0, 0, 0, 0],
          [1, 0, 0, 0],
        ],
        [
          [0, 3e-20, 0, 0],
          [0, 1, 0, 0],
        ],
        [
          [0, 0, 1e20, 0],
          [0, 0, 1, 0],
        ],
        [
          [0, 0, 0, 5],
          [0, 0, 0, 1],
        ],
      ];
      const geometry = packGeometry(splatsOf(cases.map(([rotation]) => ({ rotation }))), precision);
      for (const [i, [, expected]] of cases.entries())
        expect(unpackSplat(geometry, i).rotation.map(Math.abs)).toEqual(expected);
    });
  }

  test('log scales at the ends of the range, and all equal', () => {
    const ends = splatsOf([{ logScales: [-40, 40, 0] }, { logScales: [-1e9, 1e9, 3] }]);
    const [first, second] = [0, 1].map((i) => unpackSplat(packGeometry(ends, 'packed'), i));
    expect(Math.log(first.scale[0])).toBeCloseTo(-40, 5);
    expect(Math.log(first.scale[1])).toBeCloseTo(40, 4);
    expect(second.scale.slice(0, 2)).toEqual(first.scale.slice(0, 2));
    const equal = packGeometry(splatsOf([{ logScales: [-3.5, -3.5, -3.5] }]), 'packed');
    expect(logScalesOf(equal.chunks, 0)).toEqual({ min: -3.5, step: 0 });
    expect(unpackSplat(equal, 0).scale).toEqual(Array(3).fill(Math.exp(-3.5)));
  });

  test('packed: log scales are as exact as the range of their chunk, whatever others hold', () => {
    const set = randomSplats({ count: 1500, shDegree: 0 });
    // Each chunk's steps are half the last's; the last has the largest and smallest splat.
    for (const i of set.logScales.keys()) set.logScales[i] *= 2 ** -Math.floor(i / 768);
    set.logScales.set([-1e9, 1e9], set.logScales.length - 2);
    const { chunks } = packGeometry(set, 'packed');
    const ofCloud = chunks.slice();
    for (let chunk = 0; chunk < 6; chunk++) setLogScales(ofCloud, chunk, logScaleRange(-40, 40));
    const [own, common] = [chunks, ofCloud].map((each) => {
      const packed = packGeometry(set, 'packed', each);
      const errors = Array.from(set.logScales.subarray(0, 3 * 1280), (logScale, i) => {
        const { scale } = unpackSplat(packed, Math.floor(i / 3));
        const { step } = logScalesOf(each, Math.floor(i / 768));
        const error = Math.abs(Math.log(scale[i % 3]) - logScale);
        // Half a step, and the step and the minimum rounded to float32.
        expect(error).toBeLessThanOrEqual(step / 2 + (65535 * step + LOG_SCALE_LIMIT) * 2 ** -23);
        return error;
      });
      return Math.hypot(...errors);
    });
    expect(own).toBeLessThan(common / 20);
  });

  test('no splats', () => {
    for (const precision of ['f32', 'packed'] as const)
      expect(packGeometry(splatsOf([]), precision).words).toHaveLength(0);
  });
});
