import { perspectiveCamera } from '@websplatter/core';
import { expect, it } from 'vitest';
import { scenePlaceOf } from './scene-place.ts';

type SeenBy = Parameters<typeof scenePlaceOf>[0];

function seen(distance: number, radius: number | null, cameraZ?: number): SeenBy {
  const camera =
    cameraZ &&
    perspectiveCamera({ position: [0, 0, cameraZ], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 });
  return {
    camera: {
      controls: { home: { target: [0, 1, 0], distance } },
      subjectSphere: radius && { center: [0, 0, 1], radius },
    },
    shownFrame: camera ? { frame: { camera } } : null,
  } as unknown as SeenBy;
}

it('is the scene as a whole where the first view frames it', () => {
  expect(scenePlaceOf(seen(5, 2))).toEqual({ center: [0, 0, 1], radius: 2, viewDepth: 4 });
});

it('is what the first view looks at where a background is far away', () => {
  expect(scenePlaceOf(seen(1.5, 80))).toEqual({ center: [0, 1, 0], radius: 0.75, viewDepth: 1.5 });
});

it('has its depth in the view that is shown, at least its radius', () => {
  expect(scenePlaceOf(seen(5, 2, 9)).viewDepth).toBeCloseTo(8, 9);
  expect(scenePlaceOf(seen(5, 2, 1.5)).viewDepth).toBe(2);
});

it('is there before there is a scene', () => {
  expect(scenePlaceOf(seen(3, null))).toMatchObject({ center: [0, 1, 0], radius: 1 });
});
