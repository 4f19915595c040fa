import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { orthographicCamera, perspectiveCamera, projectionOf } from '../data/camera/camera.ts';
import { uniform } from '../testing/uniform.ts';
import { rotationMatrix, screenAxes, screenCovariance, screenRows } from './covariance.ts';

/** Converts a finite double to an exact integer, in units of 2^-1100. */
function exact(value: number): bigint {
  const view = new DataView(new ArrayBuffer(8));
  view.setFloat64(0, value);
  const bits = view.getBigUint64(0);
  const exponent = Number((bits >> 52n) & 0x7ffn);
  const fraction = bits & 0xfffffffffffffn;
  const magnitude = exponent === 0 ? fraction : fraction | 0x10000000000000n;
  const shifted = magnitude << BigInt(Math.max(exponent, 1) - 1075 + 1100);
  return bits >> 63n ? -shifted : shifted;
}

/** Nearest double, to some 60 bits, of numerator · 2^-(1100·power). */
function inexact(numerator: bigint, power: number): number {
  if (numerator === 0n) return 0;
  const magnitude = numerator < 0n ? -numerator : numerator;
  const drop = Math.max(0, magnitude.toString(2).length - 60);
  const value =
    Number(magnitude >> BigInt(drop)) * 2 ** ((drop - 1100 * power) / 2) * 2 ** ((drop - 1100 * power) / 2);
  return numerator < 0n ? -value : value;
}

/** Determinant a·c − b² of B·Bᵀ + dilation: the naive formula in exact arithmetic. */
function exactDeterminant(rows: readonly number[], dilationPx2: number): number {
  const [x0, x1, x2, y0, y1, y2] = rows.map(exact);
  const dilation = exact(dilationPx2) << 1100n;
  const a = x0 * x0 + x1 * x1 + x2 * x2 + dilation;
  const b = x0 * y0 + x1 * y1 + x2 * y2;
  const c = y0 * y0 + y1 * y1 + y2 * y2 + dilation;
  return inexact(a * c - b * b, 4);
}

/** Rows of needles: both nearly along one line, up to 10,000 px long, a millionth as thick. */
const coordinate = uniform(-1, 1);
const needleRows = fc
  .record({
    along: fc.tuple(coordinate, coordinate, coordinate),
    lengths: fc.tuple(uniform(-1e4, 1e4), uniform(-1e4, 1e4)),
    thin: fc.tuple(coordinate, coordinate, coordinate),
    thickness: fc.constantFrom(0, 1e-6, 1e-3, 1, 100),
  })
  .map(({ along, lengths, thin, thickness }) => [
    ...along.map((v) => lengths[0] * v),
    ...along.map((v, i) => lengths[1] * v + thickness * thin[i]),
  ]);

describe('the covariance on the screen', () => {
  test('has the right determinant for needles, for which a·c − b² is wrong', () => {
    let worstNaive = 0;
    fc.assert(
      fc.property(needleRows, (rows) => {
        const { a, b, c, determinant } = screenCovariance(rows, 0.3);
        const expected = exactDeterminant(rows, 0.3);
        worstNaive = Math.max(worstNaive, Math.abs((a * c - b * b) / expected - 1));
        // The cross product n errs by some u·s² for rows of length s, which moves the determinant,
        // at least n² + d·s², by 2n·u·s²: at most u·s/√d of it.
        const longest = Math.hypot(...rows);
        expect(Math.abs(determinant / expected - 1)).toBeLessThan(2 ** -50 * (1 + longest / Math.sqrt(0.3)));
        expect(determinant).toBeGreaterThanOrEqual(0.3 * 0.3);
      }),
      { numRuns: 500 },
    );
    expect(worstNaive).toBeGreaterThan(1e-9);
  });

  test('has eigenvectors as axes: Σ·e = λ·e, perpendicular, major before minor', () => {
    fc.assert(
      fc.property(needleRows, (rows) => {
        const { a, b, c, determinant } = screenCovariance(rows, 0.3);
        const { majorPx, minorPx } = screenAxes({ a, b, c, determinant });
        const [major, minor] = [Math.hypot(...majorPx), Math.hypot(...minorPx)];
        expect(major).toBeGreaterThanOrEqual(minor);
        expect(Math.abs(majorPx[0] * minorPx[0] + majorPx[1] * minorPx[1])).toBeLessThanOrEqual(
          1e-12 * major * minor,
        );
        // Half axes are √(2λ) long: both eigenvalues together give the determinant.
        expect((major * major * minor * minor) / 4 / determinant).toBeCloseTo(1, 9);
        expect((major * major + minor * minor) / 2 / (a + c)).toBeCloseTo(1, 9);
        const [x, y] = majorPx.map((v) => v / major);
        const larger = (major * major) / 2;
        expect(Math.hypot(a * x + b * y - larger * x, b * x + c * y - larger * y)).toBeLessThanOrEqual(
          1e-7 * larger,
        );
      }),
      { numRuns: 500 },
    );
  });

  test('has axes even if it is a circle', () => {
    const { majorPx, minorPx } = screenAxes({ a: 2, b: 0, c: 2, determinant: 4 });
    expect(majorPx).toEqual([2, 0]);
    expect(minorPx.map((v) => v + 0)).toEqual([0, 2]);
  });

  test('has axes along x and y, in either order', () => {
    expect(screenAxes({ a: 8, b: 0, c: 2, determinant: 16 }).majorPx.map(Math.abs)).toEqual([4, 0]);
    expect(screenAxes({ a: 2, b: 0, c: 8, determinant: 16 }).majorPx.map(Math.abs)).toEqual([0, 4]);
  });
});

describe('rotationMatrix', () => {
  test('is a rotation for any quaternion, independent of its length and sign', () => {
    const component = uniform(-1, 1);
    fc.assert(
      fc.property(component, component, component, component, (w, x, y, z) => {
        const m = rotationMatrix(w, x, y, z);
        for (let i = 0; i < 3; i++) {
          for (let j = 0; j < 3; j++) {
            const dot = m[3 * i] * m[3 * j] + m[3 * i + 1] * m[3 * j + 1] + m[3 * i + 2] * m[3 * j + 2];
            expect(dot).toBeCloseTo(i === j ? 1 : 0, 10);
          }
        }
        for (const factor of [-1, 1e-150, 1e150]) {
          if (Math.max(...[w, x, y, z].map(Math.abs)) < 1e-100) continue;
          const scaled = rotationMatrix(factor * w, factor * x, factor * y, factor * z);
          for (const [k, value] of scaled.entries()) expect(value).toBeCloseTo(m[k], 10);
        }
      }),
    );
  });

  test('turns counterclockwise about its axis, row-major; is the identity for length 0', () => {
    const half = Math.SQRT1_2;
    const near = (values: number[]) => values.map((v) => expect.closeTo(v, 12));
    expect(rotationMatrix(half, 0, 0, half)).toEqual(near([0, -1, 0, 1, 0, 0, 0, 0, 1]));
    expect(rotationMatrix(half, half, 0, 0)).toEqual(near([1, 0, 0, 0, 0, -1, 0, 1, 0]));
    expect(rotationMatrix(0, 0, 0, 0)).toEqual([1, 0, 0, 0, 1, 0, 0, 0, 1]);
  });
});

describe('screenRows', () => {
  const place = { position: [0, 0, 0], target: [0, 0, -1], aspect: 2 } as const;
  const identity = [1, 0, 0, 0, 1, 0, 0, 0, 1];

  test('are the derivative of the projected position, as long as the Jacobian is not clamped', () => {
    const projection = projectionOf(perspectiveCamera({ ...place, fovYDegrees: 60 }), 200, 100);
    const center = [0.7, -0.4, -3];
    const rotation = rotationMatrix(0.8, 0.2, -0.3, 0.1);
    const logScales = [-1, 0.5, -2];
    const rows = screenRows(projection, identity, center, rotation, logScales);
    const pixel = ([x, y, z]: number[]) => [
      projection.centerPx[0] + (projection.focalPx[0] * x) / -z,
      projection.centerPx[1] - (projection.focalPx[1] * y) / -z,
    ];
    for (let axis = 0; axis < 3; axis++) {
      const h = 1e-6;
      const moved = (sign: number) =>
        pixel(center.map((v, r) => v + sign * h * Math.exp(logScales[axis]) * rotation[3 * r + axis]));
      const [plus, minus] = [moved(1), moved(-1)];
      for (const row of [0, 1])
        expect(rows[3 * row + axis]).toBeCloseTo((plus[row] - minus[row]) / (2 * h), 5);
    }
  });

  test('keep the values of the clamp outside of the image', () => {
    const projection = projectionOf(perspectiveCamera({ ...place, fovYDegrees: 60 }), 200, 100);
    const at = (tangent: number) =>
      screenRows(projection, identity, [3 * tangent, 0, -3], identity, [0, 0, 0]);
    expect(at(projection.clampX[1] + 5)).toEqual(at(projection.clampX[1]));
    expect(at(projection.clampX[1])).not.toEqual(at(projection.clampX[1] - 0.1));
  });

  test('do not depend on the splat’s place if the camera is orthographic', () => {
    const projection = projectionOf(orthographicCamera({ ...place, height: 4 }), 200, 100);
    const rows = screenRows(projection, identity, [90, -3, -7], identity, [Math.log(2), 0, 5]);
    expect(rows.map((v) => v + 0)).toEqual([50, 0, 0, 0, -25, 0].map((v) => expect.closeTo(v, 12)));
  });
});
