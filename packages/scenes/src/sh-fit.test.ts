import { describe, expect, it } from 'vitest';
import { evaluateShBasis, FIT_DIRECTIONS, fibonacciDirections, ShFit } from './sh-fit.ts';

/** A frame that is no axis permutation: rotated about (1, 2, 3). */
const FRAME = rotationAbout([1, 2, 3], 1.1);

function rotationAbout(axis: [number, number, number], angle: number): Float64Array {
  const length = Math.hypot(...axis);
  const [x, y, z] = axis.map((component) => component / length);
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  const t = 1 - c;
  return new Float64Array([
    t * x * x + c,
    t * x * y - s * z,
    t * x * z + s * y,
    t * x * y + s * z,
    t * y * y + c,
    t * y * z - s * x,
    t * x * z - s * y,
    t * y * z + s * x,
    t * z * z + c,
  ]);
}

function evaluate(coefficients: Float64Array, direction: ArrayLike<number>): number {
  const basis = new Float64Array(16);
  evaluateShBasis(3, direction[0], direction[1], direction[2], basis);
  return basis.reduce((sum, value, j) => sum + value * coefficients[3 * j], 0.5);
}

/** The world direction camera → splat of a local view towards the camera. */
function worldDirection(view: ArrayLike<number>): [number, number, number] {
  return [0, 1, 2].map((k) => -(view[0] * FRAME[k] + view[1] * FRAME[3 + k] + view[2] * FRAME[6 + k])) as [
    number,
    number,
    number,
  ];
}

function samplesOf(fit: ShFit, color: (view: ArrayLike<number>) => number): Float64Array {
  const samples = new Float64Array(3 * FIT_DIRECTIONS);
  for (let i = 0; i < FIT_DIRECTIONS; i++)
    samples.fill(color(fit.views.subarray(3 * i, 3 * i + 3)), 3 * i, 3 * i + 3);
  return samples;
}

describe('evaluateShBasis', () => {
  it('is orthonormal over the sphere', () => {
    const count = 4096;
    const directions = fibonacciDirections(count, -1);
    const basis = new Float64Array(16);
    const gram = new Float64Array(256);
    for (let i = 0; i < count; i++) {
      evaluateShBasis(3, directions[3 * i], directions[3 * i + 1], directions[3 * i + 2], basis);
      for (let j = 0; j < 16; j++) {
        for (let k = 0; k < 16; k++) gram[16 * j + k] += (4 * Math.PI * basis[j] * basis[k]) / count;
      }
    }
    for (let j = 0; j < 16; j++) {
      for (let k = 0; k < 16; k++) expect(gram[16 * j + k]).toBeCloseTo(j === k ? 1 : 0, 2);
    }
  });
});

describe('ShFit', () => {
  const coefficients = new Float64Array(48);

  it('fits smooth colours over the whole sphere, in any frame', () => {
    const fit = new ShFit(3, 'both');
    const color = (view: ArrayLike<number>) => 0.5 + 0.2 * view[2] + 0.1 * view[0] * view[1];
    fit.fit(samplesOf(fit, color), FRAME, coefficients);
    for (let i = 0; i < FIT_DIRECTIONS; i++) {
      const view = fit.views.subarray(3 * i, 3 * i + 3);
      expect(evaluate(coefficients, worldDirection(view))).toBeCloseTo(color(view), 2);
    }
  });

  it('puts a highlight where it was seen and stays bounded behind the surface', () => {
    const fit = new ShFit(3, 'front');
    const bright = [0.5, 0, Math.sqrt(0.75)];
    const color = (view: ArrayLike<number>) =>
      0.2 + 0.8 * Math.max(0, view[0] * bright[0] + view[1] * bright[1] + view[2] * bright[2]) ** 20;
    fit.fit(samplesOf(fit, color), FRAME, coefficients);
    expect(evaluate(coefficients, worldDirection(bright))).toBeGreaterThan(0.45);
    expect(evaluate(coefficients, worldDirection([-0.5, 0, Math.sqrt(0.75)]))).toBeLessThan(0.35);
    for (const view of [
      [0, 0, -1],
      [0.7, 0, -0.7],
      [-0.7, 0, -0.7],
    ]) {
      expect(Math.abs(evaluate(coefficients, worldDirection(view)))).toBeLessThan(1);
    }
  });
});
