import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { expectClose, FRONT } from '../camera/orbit-pose.fixture.ts';
import {
  cameraAxes,
  dollied,
  dolliedAt,
  focused,
  lookAt,
  mixed,
  moved,
  type OrbitPose,
  orbited,
  panned,
  poseFromLookAt,
  unwound,
} from './orbit-pose.ts';
import { dot, subtract, type Vec3 } from './vec3.ts';

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

  it('keeps in its place in the image what a zoom goes towards', () => {
    const anywhere = fc.double({ min: -2, max: 2, noNaN: true });
    const factors = fc.double({ min: 0.1, max: 10, noNaN: true });
    fc.assert(
      fc.property(pose, anywhere, anywhere, factors, (before, right, up, factor) => {
        const halfHeight = before.distance * Math.tan(Math.PI / 6);
        const seen = moved(before, [right * halfHeight, up * halfHeight, 0]).target;
        const after = dolliedAt(before, factor, { min: 0, max: Infinity }, { right, up }, 60);
        const place = imagePlace(after, seen, 60);
        expect(place[0]).toBeCloseTo(right, 6);
        expect(place[1]).toBeCloseTo(up, 6);
      }),
    );
  });

  it('stands still where a zoom has come to its end', () => {
    const range = { min: 1, max: 10 };
    expect(dolliedAt(FRONT, 2, range, { right: 1, up: 1 }, 60)).toEqual(FRONT);
  });

  it('focuses a point by moving sideways, at the depth that it has', () => {
    const range = { min: 0, max: Infinity };
    expect(focused(FRONT, [3, 4, 5], range)).toEqual({ ...FRONT, target: [3, 4, 5], distance: 5 });
    fc.assert(
      fc.property(pose, point, (before, goal) => {
        const after = focused(before, goal, range);
        const way = subtract(lookAt(after).position, lookAt(before).position);
        // Of a point behind the camera there is no depth to keep.
        if (after.distance > 0) expect(dot(way, cameraAxes(before).back)).toBeCloseTo(0, 6);
      }),
    );
    expect(focused(FRONT, [0, 0, 20], { min: 1, max: 9 }).distance).toBe(1);
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

/** Right and up of the image's middle, in halves of its height, where `point` is seen. */
function imagePlace(from: OrbitPose, point: Vec3, fovYDegrees: number): [number, number] {
  const { right, above, back } = cameraAxes(from);
  const offset = subtract(point, lookAt(from).position);
  const halfHeight = -dot(offset, back) * Math.tan((fovYDegrees * Math.PI) / 360);
  return [dot(offset, right) / halfHeight, dot(offset, above) / halfHeight];
}
