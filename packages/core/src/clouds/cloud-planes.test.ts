import { describe, expect, test } from 'vitest';
import type { ShPrecision } from '../data/packing/precision.ts';
import { largestPlaneBytes, nearestPrecision } from './cloud-planes.ts';

describe('planes', () => {
  test('nearestPrecision prefers the same precision, else the next finer, else the finest', () => {
    const order: readonly ShPrecision[] = ['f32', 'f16', 'u8'];
    const nearest = (held: readonly ShPrecision[], wanted: ShPrecision) =>
      nearestPrecision(held, wanted, order);
    expect(nearest(['f32', 'f16', 'u8'], 'f16')).toBe('f16');
    expect(nearest(['f32', 'f16'], 'u8')).toBe('f16');
    expect(nearest(['u8', 'f32'], 'f16')).toBe('f32');
    expect(nearest(['u8', 'f16'], 'f32')).toBe('f16');
    expect(nearest(['u8'], 'f32')).toBe('u8');
  });

  test('are paged by the largest plane that a cloud of their degree may have', () => {
    expect(([0, 1, 2, 3] as const).map(largestPlaneBytes)).toEqual([64, 64, 96, 180]);
  });
});
