import { expect } from 'vitest';
import type { OrbitPose } from '../state/orbit-pose.ts';
import type { Vec3 } from '../state/vec3.ts';

/** For tests: a camera on +z, 10 from its target. */
export const FRONT: OrbitPose = {
  target: [0, 0, 0],
  distance: 10,
  azimuth: 0,
  polar: Math.PI / 2,
  up: [0, 1, 0],
};

export function expectClose(actual: Vec3, expected: Vec3, tolerance = 1e-9) {
  const error = Math.hypot(actual[0] - expected[0], actual[1] - expected[1], actual[2] - expected[2]);
  expect(error, `[${actual}] against [${expected}]`).toBeLessThan(tolerance);
}
