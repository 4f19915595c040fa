import { expect, test } from 'vitest';
import { seededRandom } from '../../testing/seeded-random.ts';
import { principalAxes } from './principal-axes.ts';

test.each([1, 2, 9, 45])('axes of %i values are orthonormal eigenvectors, the largest first', (n) => {
  const random = seededRandom(n);
  const factors = Float64Array.from({ length: n * n }, () => random() - 0.5);
  const matrix = new Float64Array(n * n);
  for (let i = 0; i < n; i++)
    for (let j = 0; j < n; j++)
      for (let k = 0; k < n; k++) matrix[i * n + j] += factors[i * n + k] * factors[j * n + k];
  const axes = principalAxes(matrix, n);
  const row = (k: number) => axes.subarray(k * n, (k + 1) * n);
  const dot = (a: Float64Array, b: Float64Array) => a.reduce((sum, value, i) => sum + value * b[i], 0);
  const image = (k: number) => row(k).map((_, i) => dot(matrix.subarray(i * n, (i + 1) * n), row(k)));
  let before = Number.POSITIVE_INFINITY;
  let worst = 0;
  for (let k = 0; k < n; k++) {
    const images = image(k);
    const value = dot(images, row(k));
    expect(value).toBeLessThanOrEqual(before + 1e-12);
    before = value;
    for (let i = 0; i < n; i++) {
      worst = Math.max(worst, Math.abs(images[i] - value * row(k)[i]));
      worst = Math.max(worst, Math.abs(dot(row(i), row(k)) - (i === k ? 1 : 0)));
    }
  }
  expect(worst).toBeLessThan(1e-11);
});

test('axes of equal values, or of values along axes already, are those of the values', () => {
  expect([...principalAxes(new Float64Array(4), 2)]).toEqual([1, 0, 0, 1]);
  expect([...principalAxes(Float64Array.of(1, 0, 0, 9), 2)]).toEqual([0, 1, 1, 0]);
});
