import { orthographicCamera, perspectiveCamera } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { distanceAlong, seenAxis } from './axis-layout.ts';

const size = { width: 600, height: 400 };
const view = { position: [0, 0, 4], target: [0, 0, 0], aspect: 1.5 } as const;
const cameras = {
  perspective: perspectiveCamera({ ...view, fovYDegrees: 60, near: 0.1, far: 100 }),
  parallel: orthographicCamera({ ...view, height: 4, near: 0.1, far: 100 }),
};
const AXES = [
  [1, 0, 0],
  [0, 1, 0],
  [0, 0, 1],
] as const;

describe.each(['perspective', 'parallel'] as const)('axes in %s', (kind) => {
  const space = { camera: cameras[kind], ...size };

  it('are as long as they are to be where they lie across the view, and not to be dragged end on', () => {
    const [x, y, z] = AXES.map((axis) => seenAxis(space, [0, 0, 0], axis, 70)!);
    expect(x.from[0]).toBeCloseTo(300);
    expect(x.from[1]).toBeCloseTo(200);
    expect(x.to[0]).toBeCloseTo(370);
    // Up in the scene is up in the image.
    expect(y.to[1]).toBeCloseTo(130);
    expect([x, y, z].map(({ canDrag }) => canDrag)).toEqual([true, true, false]);
  });

  it('tell how far along them a place in the image is', () => {
    const slanted = [0.6, 0, 0.8] as const;
    for (const distance of [-2, 0.5, 3]) {
      const point = [distance * slanted[0], 0, distance * slanted[2]] as const;
      const { from } = seenAxis(space, point, AXES[0], 1)!;
      // Beside the axis, straight across it.
      const found = distanceAlong(space, [0, 0, 0], slanted, [from[0], from[1] + 50]);
      expect(found).toBeCloseTo(distance, 9);
    }
  });
});

it('axes behind the camera are not seen', () => {
  const space = { camera: cameras.perspective, ...size };
  expect(seenAxis(space, [0, 0, 5], AXES[0], 70)).toBeNull();
  expect(distanceAlong(space, [0, 0, 0], [0, 0, 1], [300, 200])).toBeNull();
});
