import { expect, test } from 'vitest';
import { cameraPosition, perspectiveCamera } from '../data/camera/camera.ts';
import { sampleCameras } from './sample-cameras.ts';

const bounds = { min: [-1, -1, -1], max: [1, 1, 1] } as const;
const camera = perspectiveCamera({ position: [0, 0, 5], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 });

test('samples the camera itself and others that look at the same place', () => {
  const cameras = sampleCameras(camera, bounds);
  expect(cameras).toHaveLength(8);
  expect(cameras[0]).toBe(camera);
  expect(sampleCameras(camera, bounds)).toEqual(cameras);
  const positions = new Set<string>();
  for (const { viewMatrix, projectionMatrix } of cameras) {
    expect(projectionMatrix).toBe(camera.projectionMatrix);
    // The middle of the bounds stays on the line of sight, in front.
    expect(Math.hypot(viewMatrix[12], viewMatrix[13])).toBeLessThan(1e-9);
    const distance = Math.hypot(...cameraPosition(viewMatrix));
    expect(-viewMatrix[14]).toBeCloseTo(distance);
    expect(distance).toBeGreaterThan(3);
    expect(distance).toBeLessThan(8);
    positions.add(
      cameraPosition(viewMatrix)
        .map((x) => x.toFixed(3))
        .join(),
    );
  }
  expect(positions.size).toBe(8);
});

test('turns about a place in front even from inside the bounds', () => {
  const inside = perspectiveCamera({ position: [0, 0, 0], target: [0, 0, -1], fovYDegrees: 50, aspect: 1 });
  for (const { viewMatrix } of sampleCameras(inside, bounds, 4))
    expect(Math.hypot(...cameraPosition(viewMatrix))).toBeLessThan(1);
  expect(() => sampleCameras(camera, bounds, 0)).toThrow('count is 0');
});
