import { expect, test } from 'vitest';
import { cameraPosition, perspectiveCamera } from '../data/camera/camera.ts';
import { orbitCameras } from './orbit-cameras.ts';

const bounds = { min: [-1, -1, -1], max: [1, 1, 1] } as const;
const camera = perspectiveCamera({ position: [0, 0, 5], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 });

test('every frame has another camera, at one distance from the pivot, with the given one in the middle', () => {
  const cameras = orbitCameras(camera, bounds, { count: 9, sweepDegrees: 18 });
  const places = cameras.map(({ viewMatrix }) => cameraPosition(viewMatrix));
  const degrees = places.map(([x, , z]) => (Math.atan2(x, z) * 180) / Math.PI);
  for (const [i, place] of places.entries()) {
    expect(Math.hypot(...place)).toBeCloseTo(5, 12);
    expect(place[1]).toBeCloseTo(0, 12);
    if (i > 0) expect(Math.abs(degrees[i] - degrees[i - 1])).toBeCloseTo(2, 10);
  }
  expect(degrees[4]).toBeCloseTo(0, 12);
});

test('a whole turn ends one step before its beginning', () => {
  const cameras = orbitCameras(camera, bounds, { count: 4, sweepDegrees: 360 });
  const places = cameras.map(({ viewMatrix }) =>
    cameraPosition(viewMatrix)
      .map((x) => Math.round(x))
      .join(),
  );
  expect(new Set(places).size).toBe(4);
});

test.each([
  [{ count: 0, sweepDegrees: 10 }, 'count is 0'],
  [{ count: 1.5, sweepDegrees: 10 }, 'count is 1.5'],
  [{ count: 3, sweepDegrees: 0 }, 'sweepDegrees is 0'],
  [{ count: 3, sweepDegrees: 361 }, 'sweepDegrees is 361'],
  [{ count: 3, sweepDegrees: Number.NaN }, 'sweepDegrees is NaN'],
])('%j is refused', (options, message) => {
  expect(() => orbitCameras(camera, bounds, options)).toThrow(message);
});
