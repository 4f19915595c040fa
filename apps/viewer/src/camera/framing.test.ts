import { describe, expect, it } from 'vitest';
import { depthRange, firstPose, fitDistance, parallelView } from './framing.ts';

const UNIT = { center: [0, 0, 0], radius: 1 } as const;

describe('framing', () => {
  it('fits the narrower side of the image', () => {
    expect(fitDistance(1, 60, 2)).toBeCloseTo(2);
    expect(fitDistance(1, 60, 0.5)).toBeGreaterThan(3);
  });

  it('comes closer to what is smaller than its sphere, and stays outside of it', () => {
    const distanceOf = (x: number, y: number, z: number) => {
      const radius = Math.hypot(x, y, z);
      return firstPose({ center: [0, 0, 0], radius, halfSize: [x, y, z] }, 50, 1.6).distance / radius;
    };
    const ofSphere = fitDistance(1, 50, 1.6);
    expect(distanceOf(1, 1, 1) / ofSphere).toBeCloseTo(1.2 / Math.sqrt(3));
    for (const [x, y, z] of [
      [1, 0.1, 1],
      [3, 1, 1],
      [0.01, 0.01, 1],
    ]) {
      expect(distanceOf(x, y, z)).toBeGreaterThanOrEqual(1.5);
      expect(distanceOf(x, y, z)).toBeLessThan(ofSphere);
    }
  });

  it('sees all of the scene between its depths', () => {
    const pose = firstPose(UNIT, 50, 1.6);
    const { near, far } = depthRange(pose, UNIT, UNIT);
    expect(near).toBeLessThan(pose.distance - 1);
    expect(far).toBeGreaterThan(pose.distance + 1);
    expect(Math.log2(far / near) % 1).toBe(0);
  });

  it('keeps its depths while the camera turns', () => {
    const pose = firstPose(UNIT, 50, 1);
    const turned = { ...pose, azimuth: pose.azimuth + 1 };
    expect(depthRange(turned, UNIT, UNIT)).toEqual(depthRange(pose, UNIT, UNIT));
  });

  it('sees all of the scene in parallel, however near the pose is', () => {
    const pose = { ...firstPose(UNIT, 50, 1), target: [0.5, 0, 0], distance: 0.01 } as const;
    const { position, near, far, height } = parallelView(pose, UNIT, 90);
    expect(height).toBeCloseTo(0.02);
    const toCenter = Math.hypot(...position);
    expect(toCenter - 1).toBeGreaterThanOrEqual(0);
    expect(near).toBeGreaterThan(0);
    expect(far).toBeGreaterThanOrEqual(toCenter + 1);
  });

  it('begins above the ground for any up', () => {
    const { up, polar } = firstPose(UNIT, 50, 1, [0, 0, 1]);
    expect(up).toEqual([0, 0, 1]);
    expect(polar).toBeLessThan(Math.PI / 2);
  });
});
