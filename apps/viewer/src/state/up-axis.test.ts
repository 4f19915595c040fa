import { describe, expect, it } from 'vitest';
import {
  isUpsideDown,
  nearestUpAxis,
  oppositeAxis,
  UP_AXES,
  upAxisOf,
  uprightnessOf,
  upVector,
} from './up-axis.ts';

describe('the axis that points up', () => {
  it('is told by how the scene is drawn, and the other way round', () => {
    for (const axis of UP_AXES) expect(upAxisOf(uprightnessOf(axis))).toBe(axis);
    expect(uprightnessOf('-z')).toEqual({ isFlipped: true, isZUp: true });
    expect(UP_AXES.map(oppositeAxis)).toEqual(['-y', 'y', '-z', 'z']);
    expect(upVector({ isZUp: true })).toEqual([0, 0, 1]);
  });

  it('is the one nearest to a direction', () => {
    expect(nearestUpAxis([0.3, -0.9, 0.1])).toBe('-y');
    expect(nearestUpAxis([0, 0.6, 0.8])).toBe('z');
    // No axis of the scene's own is sideways.
    expect(nearestUpAxis([1, 0, 0])).toBe('y');
  });

  it('is turned where it is not as the scene came', () => {
    expect(isUpsideDown({ isFlipped: true, isZUp: false }, '-y')).toBe(false);
    expect(isUpsideDown({ isFlipped: false, isZUp: false }, '-y')).toBe(true);
    // A scene with z up is upright as it is.
    expect(isUpsideDown({ isFlipped: false, isZUp: true }, '-y')).toBe(false);
    expect(isUpsideDown({ isFlipped: true, isZUp: true }, 'z')).toBe(true);
  });
});
