import type { Vec3 } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { classOf, ERROR_CLASSES } from './error-classes.ts';

describe('classes of errors', () => {
  it.each([
    [0, '0'],
    [0.49, '0'],
    [1, '1'],
    [2.4, '2'],
    [4, '4'],
    [8, '8'],
    [11.9, '8'],
    [16, '16+'],
    [255, '16+'],
  ])('puts %d steps into the class %s', (steps, label) =>
    expect(ERROR_CLASSES[classOf(steps)].label).toBe(label),
  );

  it('orders its colours by lightness, in steps that can be told apart', () => {
    const lightness = ERROR_CLASSES.map(({ color }) => cieLightness(color));
    const gaps = lightness.slice(1).map((value, i) => value - lightness[i]);
    expect(Math.min(...gaps)).toBeGreaterThan(12);
    expect(Math.max(...gaps)).toBeLessThan(26);
  });
});

/** CIE L*, 0…100. */
function cieLightness(color: Vec3): number {
  const [r, g, b] = color.map((value) => {
    const part = value / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  });
  const y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  return y > 216 / 24389 ? 116 * Math.cbrt(y) - 16 : (y * 24389) / 27;
}
