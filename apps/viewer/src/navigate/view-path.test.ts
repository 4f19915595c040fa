import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { expectClose, FRONT } from '../camera/orbit-pose.fixture.ts';
import { lookAt, type OrbitPose } from '../state/orbit-pose.ts';
import { pathMs, pathThrough, placeOnPath, poseOnPath } from './view-path.ts';

const coordinate = fc.double({ min: -100, max: 100, noNaN: true });
const pose: fc.Arbitrary<OrbitPose> = fc.record({
  target: fc.tuple(coordinate, coordinate, coordinate),
  distance: fc.double({ min: 0.1, max: 100, noNaN: true }),
  azimuth: fc.double({ min: -20, max: 20, noNaN: true }),
  polar: fc.double({ min: 0.02, max: 3.12, noNaN: true }),
  up: fc.constant([0, 1, 0] as const),
});
const path = fc.array(pose, { minLength: 1, maxLength: 6 });

describe('a path through views', () => {
  it('passes every view', () => {
    fc.assert(
      fc.property(path, (poses) => {
        for (const [i, each] of poses.entries())
          expectClose(lookAt(poseOnPath(poses, i)).position, lookAt(each).position, 1e-6);
      }),
    );
  });

  it('has no jumps, and always a camera apart from its target', () => {
    fc.assert(
      fc.property(path, fc.double({ min: -1, max: 7, noNaN: true }), (poses, at) => {
        const [here, next] = [poseOnPath(poses, at), poseOnPath(poses, at + 1e-7)];
        expect(here.distance).toBeGreaterThan(0);
        expectClose(next.target, here.target, 1e-3);
        expect(Math.abs(next.azimuth - here.azimuth)).toBeLessThan(1e-3);
      }),
    );
  });

  it('leaves out views of another way up', () => {
    const view = { name: '', thumbnail: '', pose: FRONT, fovDegrees: 50, isOrthographic: false };
    const upright = { ...view, isFlipped: false, isZUp: false };
    const tilted = { ...upright, pose: { ...FRONT, up: [0, 0.8, 0.6] as const } };
    expect(pathThrough([upright, { ...upright, isFlipped: true }, tilted, upright])).toHaveLength(2);
    expect(pathThrough([tilted, upright, tilted])).toHaveLength(2);
    expect(pathThrough([])).toEqual([]);
  });

  it('turns by the shorter way round', () => {
    const middle = poseOnPath([FRONT, { ...FRONT, azimuth: 2 * Math.PI - 0.2 }], 0.5);
    expect(middle.azimuth).toBeCloseTo(-0.1);
  });

  it('stands still before its beginning and after its end', () => {
    const poses = [FRONT, { ...FRONT, distance: 40 }];
    expect(poseOnPath(poses, -3).distance).toBeCloseTo(10);
    expect(poseOnPath(poses, 9).distance).toBeCloseTo(40);
  });

  it('refuses to lead through nothing', () => {
    expect(() => poseOnPath([], 0)).toThrow(RangeError);
  });

  it('sets out slowly, passes each view at its time, and comes to rest slowly', () => {
    fc.assert(
      fc.property(
        fc.integer({ min: 2, max: 50 }),
        fc.double({ min: 0, max: 1, noNaN: true }),
        (views, part) => {
          const [place, next] = [0, 1].map((ms) => placeOnPath(part * pathMs(views) + ms, views));
          expect(next).toBeGreaterThanOrEqual(place);
          expect(next - place).toBeLessThanOrEqual(1.6 / 2500);
        },
      ),
    );
    for (const views of [1, 2, 3, 4]) {
      const places = Array.from({ length: views }, (_, i) => placeOnPath(2500 * i, views));
      expect(places).toEqual(Array.from({ length: views }, (_, i) => i));
      expect(placeOnPath(10, views)).toBeLessThan(1e-4);
      expect(views - 1 - placeOnPath(pathMs(views) - 10, views)).toBeLessThan(1e-4);
    }
    expect([placeOnPath(-1, 3), placeOnPath(1e6, 3)]).toEqual([0, 2]);
    // In between it does not slow down.
    expect(placeOnPath(2500 + 625, 4)).toBe(1.25);
  });
});
