import { expect, test } from 'vitest';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { cameraPosition, perspectiveCamera } from '../data/camera/camera.ts';
import { cameraAtDistance } from './camera-pivot.ts';

const bounds = { min: [-1, -1, -1], max: [1, 1, 1] };
const clouds = [{ cloud: { count: 1, robustBounds: bounds, checkUsable() {} } as unknown as SplatCloud }];
const camera = perspectiveCamera({ position: [0, 3, 4], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 });

test('a camera moves away from the middle of the scene, and looks as before', () => {
  const far = cameraAtDistance(camera, clouds, 4);
  for (const [axis, place] of cameraPosition(far.viewMatrix).entries())
    expect(place).toBeCloseTo([0, 12, 16][axis], 12);
  for (const i of [0, 1, 2, 4, 5, 6, 8, 9, 10])
    expect(far.viewMatrix[i]).toBeCloseTo(camera.viewMatrix[i], 12);
  expect(far.projectionMatrix).toEqual(camera.projectionMatrix);
});

test.each([0, -1, Number.NaN, Number.POSITIVE_INFINITY])('a factor of %s is refused', (factor) => {
  expect(() => cameraAtDistance(camera, clouds, factor)).toThrow(`distanceFactor is ${factor}`);
});
