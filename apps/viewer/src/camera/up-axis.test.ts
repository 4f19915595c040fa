import { describe, expect, it } from 'vitest';
import { isProbablyZUp, oppositeAxis, UP_AXES, upAxisOf, uprightnessOf, upVector } from './up-axis.ts';

const box = (x: number, y: number, z: number) => ({ min: [1, 2, 3], max: [1 + x, 2 + y, 3 + z] }) as const;

describe('the axis that points up', () => {
  it('is told by how the scene is drawn, and the other way round', () => {
    for (const axis of UP_AXES) expect(upAxisOf(uprightnessOf(axis))).toBe(axis);
    expect(uprightnessOf('-z')).toEqual({ isFlipped: true, isZUp: true });
    expect(UP_AXES.map(oppositeAxis)).toEqual(['-y', 'y', '-z', 'z']);
    expect(upVector({ isZUp: true })).toEqual([0, 0, 1]);
  });

  it('is taken for z where the scene is ground that is flat along z', () => {
    expect(isProbablyZUp(box(100, 80, 10))).toBe(true);
    expect(isProbablyZUp(box(10, 9, 8))).toBe(false);
    expect(isProbablyZUp(box(100, 10, 100))).toBe(false);
  });

  it('is not taken for z of long walls, of pictures without depth and of empty scenes', () => {
    expect(isProbablyZUp(box(100, 20, 2))).toBe(false);
    expect(isProbablyZUp(box(10, 10, 0))).toBe(false);
    expect(isProbablyZUp(box(0, 0, 0))).toBe(false);
  });
});
