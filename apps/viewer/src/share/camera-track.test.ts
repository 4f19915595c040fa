import { describe, expect, it } from 'vitest';
import { isAtEnd, poseOnTrack } from './follow-settings.ts';
import type { CameraTrack } from './scene-settings.ts';

const keyAt = (timeS: number, x: number) => ({
  timeS,
  pose: { position: [x, 0, 0] as const, target: [0, x, 0] as const, fovDegrees: 60 + x },
});
const TRACK: CameraTrack = {
  durationS: 4,
  loop: 'none',
  isStepped: false,
  smoothness: 1,
  keys: [keyAt(0, 0), keyAt(1, 10), keyAt(3, 30), keyAt(4, 40)],
};
const xAt = (track: CameraTrack, elapsedS: number) => poseOnTrack(track, elapsedS).position[0];

describe('a movement of the camera', () => {
  it('passes its keys, with all that they have', () => {
    for (const { timeS, pose } of TRACK.keys) expect(poseOnTrack(TRACK, timeS)).toEqual(pose);
    expect(poseOnTrack(TRACK, 0.5).target[1]).toBeCloseTo(5);
    expect(poseOnTrack(TRACK, 0.5).fovDegrees).toBeCloseTo(65);
  });

  it('is even where its keys are', () => {
    for (const timeS of [0.25, 0.7, 1.5, 2.9, 3.3]) expect(xAt(TRACK, timeS)).toBeCloseTo(10 * timeS);
  });

  it('stands still at each key where it is not smooth', () => {
    const track = { ...TRACK, smoothness: 0 };
    expect(xAt(track, 1.001) - xAt(track, 0.999)).toBeLessThan(1e-3);
    expect(xAt(track, 0.5)).toBeCloseTo(5);
  });

  it('has a field of view whatever the file says of its smoothness', () => {
    const flat = (timeS: number, fovDegrees: number) => {
      const { pose } = keyAt(timeS, 10);
      return { timeS, pose: { ...pose, fovDegrees } };
    };
    const track = { ...TRACK, smoothness: 1e308, keys: [flat(0, 1), flat(1, 179), flat(2, 1), flat(3, 179)] };
    for (let timeS = 0; timeS < 3; timeS += 0.25) {
      const { fovDegrees } = poseOnTrack(track, timeS);
      expect(fovDegrees).toBeGreaterThanOrEqual(1);
      expect(fovDegrees).toBeLessThanOrEqual(179);
    }
  });

  it('jumps in steps where it says so', () => {
    const track = { ...TRACK, isStepped: true };
    expect([0.9, 1, 2.9].map((timeS) => xAt(track, timeS))).toEqual([0, 10, 10]);
  });

  it('stays before its first key and after its last', () => {
    const track = { ...TRACK, keys: [keyAt(1, 10), keyAt(2, 20)] };
    expect([0, 3, 9].map((timeS) => xAt(track, timeS))).toEqual([10, 20, 20]);
    expect(isAtEnd(track, 3.9)).toBe(false);
    expect(isAtEnd(track, 4)).toBe(true);
  });

  it('goes on from its last key to the first where it repeats, and back where it goes to and fro', () => {
    const keys = [keyAt(0, 0), keyAt(3, 30)];
    const repeated: CameraTrack = { ...TRACK, loop: 'repeat', keys };
    expect(xAt(repeated, 4)).toBe(0);
    expect(xAt(repeated, 3.5)).toBeGreaterThan(0);
    expect(xAt(repeated, 3.5)).toBeLessThan(30);
    const toAndFro: CameraTrack = { ...TRACK, loop: 'pingpong' };
    expect(xAt(toAndFro, 5)).toBeCloseTo(30);
    expect(xAt(toAndFro, 8)).toBeCloseTo(0);
    expect(isAtEnd(toAndFro, 100)).toBe(false);
  });
});
