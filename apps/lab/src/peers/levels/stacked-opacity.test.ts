import { expect, test } from 'vitest';
import { storedOpacity } from './stacked-opacity.ts';

test('codes up to 1 are opacities, and others are stacks that grow from 1 on', () => {
  expect(storedOpacity(0.25)).toBe(0.25 / 1.25);
  expect(storedOpacity(1)).toBe(0.5);
  // Spark codes a stack of o splats by the radius √(1 + e·ln o), of which 1…5 is 1…2.
  for (const opacity of [1.5, 10, 1000]) {
    const radius = Math.sqrt(1 + Math.E * Math.log(opacity));
    expect(storedOpacity(1 + (radius - 1) / 4)).toBeCloseTo(opacity / (1 + opacity), 12);
  }
  expect(storedOpacity(2.5)).toBe(storedOpacity(2));
});
