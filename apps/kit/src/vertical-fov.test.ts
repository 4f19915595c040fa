import { expect, test } from 'vitest';
import { verticalFov } from './vertical-fov.ts';

test('images of any shape show the same angle over their shorter side', () => {
  expect(verticalFov(50, 2)).toBeCloseTo(50);
  expect(verticalFov(90, 0.5)).toBeCloseTo((2 * Math.atan(2) * 180) / Math.PI);
});
