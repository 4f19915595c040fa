import { perspectiveCamera } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { depthAt, viewDepthsOf } from './depth-range.ts';

const bounds = { center: [1, 2, 3], radius: 2 } as const;
/** World to view, for a camera that looks at the middle of the bounds. */
function viewFrom(x: number, y: number, z: number): number[] {
  const place = { position: [x, y, z], target: [1, 2, 3], up: [0, 0, 1] } as const;
  return Array.from(perspectiveCamera({ ...place, fovYDegrees: 50, aspect: 1 }).viewMatrix);
}

describe('the scale of depths', () => {
  it('reaches over the whole scene, from all sides alike', () => {
    for (const view of [viewFrom(11, 2, 3), viewFrom(-5, 10, 3)]) {
      const { near, far } = viewDepthsOf({ bounds, focusDistance: 10 }, view);
      expect(near).toBeCloseTo(8, 9);
      expect(far).toBeCloseTo(12, 9);
    }
  });

  it('begins half-way to what the camera turns around where that is in the midst of the scene', () => {
    const { near, far } = viewDepthsOf({ bounds, focusDistance: 0.5 }, viewFrom(2, 2, 3));
    expect(near).toBe(0.25);
    expect(far).toBeCloseTo(3, 9);
  });

  it('is one where there are no depths to tell apart: behind the camera, before what it turns around, and far away', () => {
    const ahead = viewFrom(11, 2, 3);
    const behind = ahead.map((value, i) => (i % 4 === 2 ? -value : value));
    for (const [view, focusDistance] of [
      [behind, 4],
      [ahead, 100],
      [viewFrom(1e9, 2, 3), 1e9],
    ] as const) {
      const { near, far } = viewDepthsOf({ bounds, focusDistance }, view);
      expect(near).toBeGreaterThan(0);
      expect(far).toBe(2 * near);
    }
  });

  it('has steps that are even in 1/depth', () => {
    const range = { near: 2, far: 6 };
    expect([0, 0.5, 1].map((part) => depthAt(range, part))).toEqual([2, expect.closeTo(3, 12), 6]);
  });
});
