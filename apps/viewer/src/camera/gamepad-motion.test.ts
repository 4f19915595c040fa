import { describe, expect, it } from 'vitest';
import { cameraAxes, lookAt, type OrbitPose } from '../state/orbit-pose.ts';
import { dot, subtract } from '../state/vec3.ts';
import { directionOf, lookedBy, orbitedBy, sticksOf, withDeadZone } from './gamepad-motion.ts';

const FRONT: OrbitPose = { target: [0, 0, 0], distance: 2, azimuth: 0, polar: Math.PI / 2, up: [0, 1, 0] };
const RANGE = { min: 0.1, max: 10 };
const REST = { left: [0, 0], right: [0, 0], leftTrigger: 0, rightTrigger: 0 } as const;
const orbit = (sticks: object) => orbitedBy(FRONT, { ...REST, ...sticks }, 0.5, 50, RANGE);
const direction = (sticks: object) => directionOf({ ...REST, ...sticks });
const look = (sticks: object) => lookedBy(FRONT, { ...REST, ...sticks }, 0.5);

function pad(axes: readonly number[], triggers: readonly [number, number] = [0, 0]) {
  const buttons = Array.from({ length: 17 }, () => ({ value: 0, pressed: false, touched: false }));
  for (const [i, value] of triggers.entries()) buttons[6 + i].value = value;
  return { axes, buttons };
}

describe('a gamepad', () => {
  it('says nothing while it lies still, wherever its sticks rest', () => {
    expect(sticksOf(pad([0.1, -0.1, 0.05, 0.1], [0.1, 0]))).toBeNull();
    expect(sticksOf(pad([]))).toBeNull();
    expect(sticksOf({ axes: [0, 0, 0, 0], buttons: [] })).toBeNull();
  });

  it('tells of sticks and triggers', () => {
    const sticks = sticksOf(pad([1, 0, 0, -1], [0, 1]));
    expect(sticks).toMatchObject({ left: [1, 0], right: [0, -1], leftTrigger: 0, rightTrigger: 1 });
  });

  it('has a round dead zone, beyond which small ways count less', () => {
    expect(withDeadZone(0.1, 0.1)).toEqual([0, 0]);
    const [x, y] = withDeadZone(0.5, 0.5);
    expect(x).toBeCloseTo(y);
    expect(x).toBeGreaterThan(0);
    expect(x).toBeLessThan(0.5);
    // The corners of a square stick are no faster.
    expect(Math.hypot(...withDeadZone(1, 1))).toBeCloseTo(1);
    expect(withDeadZone(0, -1)[1]).toBeCloseTo(-1);
  });
});

describe('around the scene', () => {
  it('the camera goes where the right stick points', () => {
    expect(lookAt(orbit({ right: [1, 0] })).position[0]).toBeGreaterThan(0.5);
    expect(lookAt(orbit({ right: [0, -1] })).position[1]).toBeGreaterThan(0.5);
    expect(orbit({ right: [1, 0] }).distance).toBe(2);
  });

  it('the left stick moves it sideways and up, without turning it', () => {
    const { target, azimuth, polar } = orbit({ left: [1, -1] });
    expect(target[0]).toBeGreaterThan(0);
    expect(target[1]).toBeGreaterThan(0);
    expect([azimuth, polar]).toEqual([FRONT.azimuth, FRONT.polar]);
  });

  it('triggers come nearer and go away, as far as the scene allows', () => {
    expect(orbit({ rightTrigger: 1 }).distance).toBeLessThan(2);
    expect(orbit({ leftTrigger: 1 }).distance).toBeGreaterThan(2);
    expect(orbitedBy(FRONT, { ...REST, leftTrigger: 1 }, 60, 50, RANGE).distance).toBe(10);
  });
});

describe('within the scene', () => {
  it('the left stick moves ahead and sideways, the triggers up and down', () => {
    expect(direction({ left: [0, -1] })).toEqual([0, 0, 1]);
    expect(direction({ left: [1, 0], rightTrigger: 1 })).toEqual([1, 1, -0]);
    expect(direction({ leftTrigger: 1 })).toEqual([0, -1, -0]);
    expect(direction({ right: [1, 0] })).toBeNull();
  });

  it('the right stick looks around from where the camera is', () => {
    const pose = look({ right: [1, 0] });
    for (const [i, value] of subtract(lookAt(pose).position, lookAt(FRONT).position).entries())
      expect(value, `axis ${i}`).toBeCloseTo(0);
    // To the right, and with the stick pulled down, down.
    expect(dot(cameraAxes(pose).back, [1, 0, 0])).toBeLessThan(0);
    expect(dot(cameraAxes(look({ right: [0, 1] })).back, [0, 1, 0])).toBeGreaterThan(0);
  });
});
