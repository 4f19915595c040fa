import { describe, expect, test } from 'vitest';
import { shRestBasis } from '../../data/splats/spherical-harmonics.ts';
import { shColor } from './project.reference.ts';

/** Nodes and weights of Gauss–Legendre quadrature on −1…1, by Newton's method. */
function gaussLegendre(n: number): [node: number, weight: number][] {
  return Array.from({ length: n }, (_, i) => {
    let x = Math.cos((Math.PI * (i + 0.75)) / (n + 0.5));
    let derivative = 1;
    for (let step = 0; step < 50; step++) {
      let [previous, current] = [1, x];
      for (let k = 2; k <= n; k++)
        [previous, current] = [current, ((2 * k - 1) * x * current - (k - 1) * previous) / k];
      derivative = (n * (x * current - previous)) / (x * x - 1);
      x -= current / derivative;
    }
    return [x, 2 / ((1 - x * x) * derivative * derivative)];
  });
}

/** ∫ f over the unit sphere; exact for polynomials up to degree 15. */
function overSphere(f: (x: number, y: number, z: number) => number): number {
  const turns = 16;
  let sum = 0;
  for (const [z, weight] of gaussLegendre(8)) {
    for (let i = 0; i < turns; i++) {
      const angle = (2 * Math.PI * i) / turns;
      const r = Math.sqrt(1 - z * z);
      sum += ((weight * 2 * Math.PI) / turns) * f(r * Math.cos(angle), r * Math.sin(angle), z);
    }
  }
  return sum;
}

const basis = (x: number, y: number, z: number) => [1 / Math.sqrt(4 * Math.PI), ...shRestBasis(3, x, y, z)];

describe('spherical harmonics', () => {
  test('the 16 functions are orthonormal over the sphere', () => {
    for (let i = 0; i < 16; i++) {
      for (let j = 0; j <= i; j++) {
        const product = overSphere((x, y, z) => basis(x, y, z)[i] * basis(x, y, z)[j]);
        expect(product, `functions ${i} and ${j}`).toBeCloseTo(i === j ? 1 : 0, 12);
      }
    }
  });

  test('the squares of one degree add up to a constant: Unsöld', () => {
    for (const [x, y, z] of [
      [1, 0, 0],
      [0, 0, -1],
      [0.6, 0, 0.8],
      [1 / Math.sqrt(3), -1 / Math.sqrt(3), 1 / Math.sqrt(3)],
    ]) {
      const values = basis(x, y, z);
      for (const degree of [0, 1, 2, 3]) {
        const squares = values.slice(degree ** 2, (degree + 1) ** 2).map((v) => v * v);
        expect(squares.reduce((a, b) => a + b)).toBeCloseTo((2 * degree + 1) / (4 * Math.PI), 12);
      }
    }
  });

  test('have the signs that scenes are trained with', () => {
    const [x, y, z] = [0.48, 0.6, 0.64];
    const rest = shRestBasis(3, x, y, z);
    // Signs of the original implementation's SH_C1 to SH_C3 for directions of positive coordinates.
    const degree1 = [-y, z, -x].map(Math.sign);
    const degree2 = [x * y, -y * z, 2 * z * z - x * x - y * y, -x * z, x * x - y * y].map(Math.sign);
    const degree3 = [
      -y * (3 * x * x - y * y),
      x * y * z,
      -y * (4 * z * z - x * x - y * y),
      z * (2 * z * z - 3 * x * x - 3 * y * y),
      -x * (4 * z * z - x * x - y * y),
      z * (x * x - y * y),
      -x * (x * x - 3 * y * y),
    ].map(Math.sign);
    expect(rest.map(Math.sign)).toEqual([...degree1, ...degree2, ...degree3]);
  });

  test('lower degrees are the beginning of higher ones', () => {
    const all = shRestBasis(3, 0.36, 0.48, -0.8);
    for (const [degree, count] of [
      [0, 0],
      [1, 3],
      [2, 8],
    ] as const)
      expect(shRestBasis(degree, 0.36, 0.48, -0.8)).toEqual(all.slice(0, count));
  });

  test('colours: half grey and the base, the rest on top, not clamped', () => {
    const C0 = Math.sqrt(1 / (4 * Math.PI));
    expect(shColor(0, [0, 1, -1], [], [0, 0, 1])).toEqual([0.5, 0.5 + C0, 0.5 - C0]);
    expect(shColor(0, [-2, -100, 100], [], [0, 0, 1])).toEqual([
      0.5 - 2 * C0,
      0.5 - 100 * C0,
      0.5 + 100 * C0,
    ]);
    // Along z only the second function of degree 1 is not 0; each channel has its own coefficient.
    const rest = [9, 9, 9, 0.1, 0.2, 0.3, 9, 9, 9];
    const C1 = Math.sqrt(3 / (4 * Math.PI));
    const [r, g, b] = shColor(1, [0, 0, 0], rest, [0, 0, 1]);
    expect([r, g, b]).toEqual([0.1, 0.2, 0.3].map((c) => expect.closeTo(0.5 + C1 * c, 12)));
  });
});
