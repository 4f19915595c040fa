import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { cameraAxes, lookAt } from '../state/orbit-pose.ts';
import { flightDirection, flown, isFlightKey, turnedInPlace } from './fly-pose.ts';
import { expectClose, FRONT } from './orbit-pose.fixture.ts';

const angle = fc.double({ min: -7, max: 7, noNaN: true });

describe('flying', () => {
  it('turns in place, as far from the target as before', () => {
    fc.assert(
      fc.property(angle, angle, (azimuthBy, polarBy) => {
        const turned = turnedInPlace({ ...FRONT, target: [1, 2, 3] }, azimuthBy, polarBy);
        expectClose(lookAt(turned).position, [1, 2, 13]);
        expect(turned.distance).toBe(10);
      }),
    );
  });

  it('looks to the right and up by negative angles', () => {
    const { right, above } = cameraAxes(FRONT);
    const side = turnedInPlace(FRONT, -0.1, 0).target;
    expect(side[0] * right[0]).toBeGreaterThan(0);
    const higher = turnedInPlace(FRONT, 0, 0.1).target;
    expect(higher[1] * above[1]).toBeGreaterThan(0);
  });

  it('goes ahead along the line of sight, and up along the world’s up', () => {
    expectClose(flown(FRONT, [1, 2, 3]).target, [1, 2, -3]);
    const down = turnedInPlace(FRONT, 0, -1);
    expectClose(flown(down, [0, 2, 0]).target, [down.target[0], down.target[1] + 2, down.target[2]]);
  });

  it('goes where the held keys lead, at one speed', () => {
    expect(flightDirection(['KeyW'])).toEqual([0, 0, 1]);
    expect(flightDirection(['KeyW', 'ArrowUp'])).toEqual([0, 0, 1]);
    const between = flightDirection(['KeyW', 'KeyD', 'KeyQ']);
    expect(Math.hypot(...(between ?? []))).toBeCloseTo(1);
    expect(flightDirection(['KeyA', 'KeyD'])).toBeNull();
    expect(flightDirection([])).toBeNull();
  });

  it('knows its keys by their places', () => {
    expect(isFlightKey('KeyW')).toBe(true);
    expect(isFlightKey('KeyR')).toBe(false);
    expect(isFlightKey('constructor')).toBe(false);
  });
});
