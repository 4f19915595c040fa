import type { CloudInstance } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { boundingSphere, boundsOf } from './scene-bounds.ts';

describe('scene bounds', () => {
  it('has a sphere around the bounds, of radius 1 where they are a point', () => {
    expect(boundingSphere({ min: [0, 0, 0], max: [2, 4, 4] })).toEqual({
      center: [1, 2, 2],
      radius: 3,
      halfSize: [1, 2, 2],
    });
    expect(boundingSphere({ min: [5, 5, 5], max: [5, 5, 5] })).toEqual({ center: [5, 5, 5], radius: 1 });
  });

  it('has bounds around all clouds where they stand, but for empty ones', () => {
    const cloud = (count: number, bounds: object) => ({ count, bounds }) as CloudInstance['cloud'];
    const unit = { min: [-1, -1, -1], max: [1, 1, 1] };
    const clouds = [
      { cloud: cloud(2, unit) },
      { cloud: cloud(2, unit), modelMatrix: [0, 2, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1] },
      { cloud: cloud(0, { min: [Infinity, 0, 0], max: [-Infinity, 0, 0] }) },
    ];
    expect(boundsOf(clouds, 'bounds')).toEqual({ min: [-1, -2, -1], max: [11, 2, 1] });
    expect(boundsOf([], 'bounds')).toEqual({ min: [0, 0, 0], max: [0, 0, 0] });
  });
});
