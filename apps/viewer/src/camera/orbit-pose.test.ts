import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { expectClose, FRONT } from './orbit-pose.fixture.ts';
import {
  cameraAxes,
  dollied,
  lookAt,
  mixed,
  moved,
  type OrbitPose,
  orbited,
  panned,
  poseFromLookAt,
  unwound,
} from './orbit-pose.ts';
import type { Vec3 } from './vec3.ts';

const coordinate = fc.double({ min: -100, max: 100, noNaN: true });
const point = fc.tuple(coordinate, coordinate, coordinate);
const direction = point
  .filter((v) => Math.hypot(...v) > 1)
  .map((v): Vec3 => {
    const length = Math.hypot(...v);
    return [v[0] / length, v[1] / length, v[2] / length];
  });
const pose: fc.Arbitrary<OrbitPose> = fc.record({
  target: point,
  distance: fc.double({ min: 0.1, max: 1000, noNaN: true }),
  azimuth: fc.double({ min: -3.1, max: 3.1, noNaN: true }),
  polar: fc.double({ min: 0.02, max: 3.12, noNaN: true }),
  up: direction,
});

describe('poses', () => {
  it('has the camera on +z of a target that is seen from the front, with x to the right', () => {
    expectClose(lookAt(FRONT).position, [0, 0, 10]);
    const { right, above } = cameraAxes(FRONT);
    expectClose(right, [1, 0, 0]);
    expectClose(above, [0, 1, 0]);
  });

  it('is recovered from the camera that it gives, for any up', () => {
    fc.assert(
      fc.property(pose, (before) => {
        const after = poseFromLookAt(lookAt(before));
        expect(after.distance / before.distance).toBeCloseTo(1, 9);
        expect(after.azimuth).toBeCloseTo(before.azimuth, 6);
        expect(after.polar).toBeCloseTo(before.polar, 6);
      }),
    );
  });

  it('has orthonormal camera axes, right-handed', () => {
    fc.assert(
      fc.property(pose, (any) => {
        const { right, above, back } = cameraAxes(any);
        for (const axis of [right, above, back]) expect(Math.hypot(...axis)).toBeCloseTo(1, 9);
        expectClose(back, [
          right[1] * above[2] - right[2] * above[1],
          right[2] * above[0] - right[0] * above[2],
          right[0] * above[1] - right[1] * above[0],
        ]);
      }),
    );
  });

  it('refuses a camera on its target', () => {
    expect(() => poseFromLookAt({ position: [1, 2, 3], target: [1, 2, 3], up: [0, 1, 0] })).toThrow(
      RangeError,
    );
  });

  it('orbits to the side that the arrow means and stops before the poles', () => {
    expect(lookAt(orbited(FRONT, Math.PI / 2, 0)).position[0]).toBeCloseTo(10);
    expect(lookAt(orbited(FRONT, 0, -0.5)).position[1]).toBeGreaterThan(0);
    expect(orbited(FRONT, 0, -9).polar).toBeGreaterThan(0);
    expect(orbited(FRONT, 0, 9).polar).toBeLessThan(Math.PI);
  });

  it('pans so that the target follows the pointer exactly', () => {
    // At 90° and distance 10 the image is 20 units high: 100 px of 400 are 5 units.
    expectClose(panned(FRONT, 100, 0, 400, 90).target, [-5, 0, 0]);
    expectClose(panned(FRONT, 0, 100, 400, 90).target, [0, 5, 0]);
  });

  it('moves along the camera’s own axes', () => {
    const side = orbited(FRONT, Math.PI / 2, 0);
    expectClose(moved(side, [0, 0, -2]).target, [-2, 0, 0]);
  });

  it('keeps the distance within its range', () => {
    const range = { min: 1, max: 20 };
    expect(dollied(FRONT, 0.5, range).distance).toBe(5);
    expect(dollied(FRONT, 0.01, range).distance).toBe(1);
    expect(dollied(FRONT, 100, range).distance).toBe(20);
  });

  it('mixes from one pose to the other', () => {
    const to = { ...FRONT, azimuth: 1, distance: 40 };
    expect(mixed(FRONT, to, 0)).toEqual(FRONT);
    expect(mixed(FRONT, to, 1)).toEqual(to);
    expect(mixed(FRONT, to, 0.5).distance).toBeCloseTo(20);
  });

  it('unwinds to the nearest equal azimuth', () => {
    expect(unwound({ ...FRONT, azimuth: 0.1 }, 4 * Math.PI).azimuth).toBeCloseTo(4 * Math.PI + 0.1);
  });
});
